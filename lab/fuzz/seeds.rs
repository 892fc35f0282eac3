//! What a target begins with: seeds in the folder that `scripts/dev/fuzz` names, written before the target reads it.

/// Where the seeds belong; the script says it only when it starts a run.
pub const FOLDER: &str = "ROCKING_BLOCK_SEEDS";

/// Puts one seed there; without a folder, none is wanted.
pub fn plant(name: &str, bytes: &[u8]) {
    if let Some(folder) = std::env::var_os(FOLDER) {
        let path = std::path::Path::new(&folder).join(name);
        std::fs::write(&path, bytes).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    }
}
