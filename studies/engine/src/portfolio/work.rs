//! Plans → results, object by object.

use std::path::Path;

use rayon::ThreadPool;

use crate::assess::{AssessError, Cache, Results, assess};
use crate::portfolio::ranking::Portfolio;
use crate::portfolio::studies::{ObjectStudy, RefusedStudy, Studies};
use rocking_block::numerics::wide::VectorWidth;

/// A folder that keeps the rows of each object, in `NAME/kept`, for later calls of this build.
#[derive(Clone, Copy, Debug)]
pub struct Kept<'a> {
    /// The folder, which exists.
    pub folder: &'a Path,
    /// The program or library that computes: another build may step otherwise.
    pub program: &'a Path,
}

/// Assesses all objects, one after the other, and ranks them.
///
/// `each` receives the results of an object as soon as it has them. `progress` receives the object with the step, and the runs of this object.
/// An object whose rows cannot be kept is refused, and the others remain.
///
/// # Errors
/// That of `each`.
pub fn assess_all<E>(
    studies: &Studies,
    pool: &ThreadPool,
    width: Option<VectorWidth>,
    keep: Option<Kept>,
    progress: &(dyn Fn(&str, u64, u64) + Sync),
    mut each: impl FnMut(&ObjectStudy, &Results) -> Result<(), E>,
) -> Result<Portfolio, E> {
    let (mut reports, mut refused) = (Vec::new(), studies.refused.clone());
    for (number, study) in (1..).zip(&studies.valid) {
        let show = |step: &str, done, all| {
            progress(&format!("{number} of {}, {}: {step}", studies.valid.len(), study.name), done, all);
        };
        let found = kept(keep, study).and_then(|folder| {
            let keep = folder.as_deref().zip(keep).map(|(folder, kept)| Cache { folder, program: kept.program });
            assess(&study.plan, pool, width, keep, &show)
        });
        match found {
            Ok(results) => {
                each(study, &results)?;
                reports.push((study, results.report));
            }
            Err(error) => {
                let file = study.file.display().to_string();
                refused.push(RefusedStudy { reason: format!("{file}: {error}"), study: file });
            }
        }
    }
    Ok(Portfolio::new(reports, refused))
}

/// Makes the folder for the rows of an object.
fn kept(keep: Option<Kept>, study: &ObjectStudy) -> Result<Option<std::path::PathBuf>, AssessError> {
    let Some(Kept { folder, .. }) = keep else { return Ok(None) };
    let folder = folder.join(&study.name).join("kept");
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: cannot be created: {error}", folder.display()))?;
    Ok(Some(folder))
}
