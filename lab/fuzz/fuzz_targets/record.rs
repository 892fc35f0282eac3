//! Accelerogram files of every format: a record with finite values, or an error.

#![no_main]

#[path = "../seeds.rs"]
mod seeds;

use libfuzzer_sys::fuzz_target;
use rocking_records::{Choice, Format, ReadOptions, Unit, parse};

/// Small files of every format, and the beginnings of real ones.
fn plant_seeds() {
    let project = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for folder in ["lab/fuzz/seeds", "examples/records"] {
        for entry in std::fs::read_dir(project.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let mut content = std::fs::read(&path).unwrap();
            // Long inputs are slow, and no shape of a line comes first after this.
            content.truncate(8192);
            // Before the file stands the choice: of no format and no options, and of options.
            for (choice, name) in [(0, "found"), (0x80, "said")] {
                let seed = [&[choice], content.as_slice()].concat();
                seeds::plant(&format!("{}-{name}", path.file_name().unwrap().display()), &seed);
            }
        }
    }
}

fuzz_target!(init: plant_seeds(), |input: (u8, &[u8])| {
    let (choice, bytes) = input;
    let said = choice & 0x80 != 0;
    let formats: Vec<&str> = Format::NAMES.split(", ").collect();
    // No format is detection.
    let format = formats.get(usize::from(choice & 0x7f) % (formats.len() + 1)).map(|name| name.parse().unwrap());
    let options = ReadOptions {
        format: if choice & 0x7f == 0 { None } else { format },
        layout: (choice & 0x40 != 0).then(|| "10F8.2".parse().unwrap()),
        channel: said.then_some(Choice::Number(2)),
        unit: said.then_some(Unit::G),
        time_step: said.then_some(0.01),
        ..ReadOptions::default()
    };
    match parse("fuzz", bytes, &options) {
        Ok(record) => {
            assert!(record.acceleration.len() >= 2);
            assert!(record.time_step > 0.0 && record.start_time.is_finite());
            assert!(record.acceleration.iter().all(|value| value.is_finite()));
            assert!(record.peak().acceleration.is_finite() && record.at(record.start_time).is_finite());
        }
        Err(error) => assert!(!error.to_string().contains('\n')),
    }
});
