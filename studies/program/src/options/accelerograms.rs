//! Options, accelerogram files → records of ground motions.

use std::path::{Path, PathBuf};

use clap::{Arg, ArgAction, Args};

use crate::options::block::in_options;
use crate::options::input;
use crate::output::files::NamedFile;
use rocking_block::excitation::records::Ground;
use rocking_records::Record;
use rocking_studies::input::ground_files::{RecordOption, RecordOptions};
use rocking_studies::spec::RecordSpec;

/// Records of several ground motions, or of one in a command whose options are [`of_one_motion`].
#[derive(Args)]
pub struct Accelerograms {
    /// Accelerograms of horizontal ground motions, one or more, in any format of docs/studies/records.md; `-` for standard input
    #[arg(long, value_name = "FILE", num_args = 1..)]
    record: Vec<PathBuf>,
    /// Accelerograms of the vertical ground motions, in the same order; `-` for standard input
    #[arg(long, value_name = "FILE", num_args = 1..)]
    vertical: Vec<PathBuf>,
    #[command(flatten)]
    reading: RecordSpec,
}

/// Restricts the options of [`Accelerograms`] to one ground motion.
pub fn of_one_motion(option: Arg) -> Arg {
    let help = match option.get_id().as_str() {
        "record" => {
            "Accelerogram of the horizontal ground motion, in any format of docs/studies/records.md; `-` for standard input"
        }
        "vertical" => "Accelerogram of the vertical ground motion; `-` for standard input",
        _ => return option,
    };
    option.num_args(1).action(ArgAction::Set).help(help)
}

/// Files of one ground motion.
#[derive(Clone, Copy)]
pub struct MotionFiles<'a> {
    /// Horizontal record.
    pub horizontal: Option<&'a Path>,
    /// Vertical record.
    pub vertical: Option<&'a Path>,
}

impl Accelerograms {
    /// Returns whether no record is named.
    pub fn is_empty(&self) -> bool {
        self.record.is_empty() && self.vertical.is_empty()
    }

    /// Returns the files of each ground motion; without records, one motion without files.
    pub fn files(&self) -> Vec<MotionFiles<'_>> {
        let count = self.record.len().max(self.vertical.len()).max(1);
        let files = |i| MotionFiles {
            horizontal: self.record.get(i).map(PathBuf::as_path),
            vertical: self.vertical.get(i).map(PathBuf::as_path),
        };
        (0..count).map(files).collect()
    }

    /// Returns all files with the options that name them.
    pub fn named(&self) -> Vec<NamedFile> {
        let of_option = |option: &'static str, paths: &[PathBuf]| {
            paths.iter().map(|path| NamedFile::new(option, path)).collect::<Vec<_>>()
        };
        [of_option("--record", &self.record), of_option("--vertical", &self.vertical)].concat()
    }

    /// Reads the records of each ground motion, those in g with this gravity (m/s²).
    pub fn read(&self, gravity: f64) -> anyhow::Result<Vec<Ground>> {
        Ok(self.read_with_y(gravity, None)?.0)
    }

    /// Reads the records of each ground motion, and one of a second horizontal component in the same way.
    pub fn read_with_y(&self, gravity: f64, y: Option<&Path>) -> anyhow::Result<(Vec<Ground>, Option<Record>)> {
        let (horizontal, vertical) = (self.record.len(), self.vertical.len());
        anyhow::ensure!(
            horizontal == 0 || vertical == 0 || horizontal == vertical,
            "--record names {horizontal} files and --vertical {vertical}; expected equal numbers, in the same order"
        );
        let record_options = self.reading.options(gravity).map_err(in_options)?;
        let files = self.files();
        let named = files.iter().flat_map(|files| [("--record", files.horizontal), ("--vertical", files.vertical)]);
        let named = named.chain([("--record-y", y)]);
        input::check_one_standard(named.filter_map(|(option, path)| Some((option, path?))))?;
        let read = |path: Option<&Path>, is_vertical| {
            let read =
                |path| record_options.read(is_vertical, RecordOption::option, |options| input::record(path, options));
            path.map(read).transpose().map_err(anyhow::Error::msg)
        };
        let ground = |files: &MotionFiles| {
            Ok(Ground { horizontal: read(files.horizontal, false)?, vertical: read(files.vertical, true)? })
        };
        let grounds = files.iter().map(ground).collect::<anyhow::Result<Vec<_>>>()?;
        let y = read(y, false)?;
        let second = y.iter().map(|record| Ground { horizontal: Some(record.clone()), vertical: None });
        refuse_without_effect(&record_options, &grounds.iter().cloned().chain(second).collect::<Vec<_>>())?;
        Ok((grounds, y))
    }
}

/// Refuses options that none of the files needed.
pub fn refuse_without_effect(record_options: &RecordOptions, grounds: &[Ground]) -> anyhow::Result<()> {
    match record_options.unread(grounds) {
        Some((name, needed)) => anyhow::bail!("{} has no effect without {needed}", name.option()),
        None => Ok(()),
    }
}
