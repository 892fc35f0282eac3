//! Accelerogram files and their options → records.

use rocking_block::excitation::records::Ground;
use rocking_records::{ReadOptions, Record, RecordError, Setting};

/// Options for reading the files of ground motions.
#[derive(Clone, Debug, Default)]
pub struct RecordOptions {
    /// Options of horizontal and vertical files.
    pub both: ReadOptions,
    /// Options of vertical files, which override `both`, except for the gravity.
    pub vertical: ReadOptions,
}

/// A setting of record files, and its name for users.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordOption {
    /// The setting.
    pub setting: Setting,
    /// Whether it applies to vertical files only.
    pub vertical: bool,
}

impl RecordOption {
    /// The option of the command line, such as `--vertical-unit`.
    pub fn option(self) -> String {
        format!("--{}", self.key().replace('_', "-"))
    }

    /// The key in a study file, such as `vertical_unit`.
    pub fn key(self) -> String {
        let word = match self.setting {
            Setting::Format => "format",
            Setting::Unit => "unit",
            Setting::TimeStep => "dt",
            Setting::Channel => "channel",
            Setting::Layout => "layout",
            Setting::Skip => "skip",
            Setting::Npts => "npts",
            Setting::ValueScale => "value_scale",
            Setting::TimeColumn => "time_column",
            Setting::AccelerationColumn => "acceleration_column",
            Setting::Baseline => "baseline",
            Setting::BandPass => "band_pass",
            Setting::Resample => "resample",
        };
        format!("{}{word}", if self.vertical { "vertical_" } else { "" })
    }
}

impl RecordOptions {
    /// Reads a horizontal or a vertical file with `read`. Settings in the error are named by `name`.
    ///
    /// # Errors
    /// One line: the first fault of the file.
    pub fn read<T>(
        &self,
        vertical: bool,
        name: impl Fn(RecordOption) -> String,
        read: impl FnOnce(&ReadOptions) -> Result<T, RecordError>,
    ) -> Result<T, String> {
        read(&self.of(vertical)).map_err(|error| error.naming(|setting| name(RecordOption { setting, vertical })))
    }

    /// The options of horizontal or of vertical files.
    pub fn of(&self, vertical: bool) -> ReadOptions {
        if vertical { self.vertical.or(&self.both) } else { self.both.clone() }
    }

    /// The first option without effect on these ground motions, and the kind of file needed.
    pub fn unread(&self, grounds: &[Ground]) -> Option<(RecordOption, String)> {
        let horizontal: Vec<&Record> = grounds.iter().filter_map(|ground| ground.horizontal.as_ref()).collect();
        let vertical: Vec<&Record> = grounds.iter().filter_map(|ground| ground.vertical.as_ref()).collect();
        let all = [&horizontal[..], &vertical].concat();
        let vertical_settings: Vec<Setting> = self.vertical.settings().collect();
        let options_for_both = self.both.settings().map(|setting| {
            let (files, needed) = match vertical_settings.contains(&setting) {
                true => (&horizontal, "a horizontal record"),
                false => (&all, "a record"),
            };
            (RecordOption { setting, vertical: false }, files, needed)
        });
        let vertical_options = vertical_settings
            .iter()
            .map(|&setting| (RecordOption { setting, vertical: true }, &vertical, "a vertical record"));
        options_for_both.chain(vertical_options).find_map(|(name, files, needed)| {
            let formats = name.setting.formats();
            let needed = match files.is_empty() {
                true => needed.into(),
                false => {
                    let words: Vec<String> = formats.iter().map(ToString::to_string).collect();
                    match words.as_slice() {
                        [format] => format!("a {format} file"),
                        [format, other] => format!("a {format} or {other} file"),
                        _ => format!("a file of several channels ({})", words.join(", ")),
                    }
                }
            };
            let read = files.iter().any(|record| formats.contains(&record.format));
            (!read).then_some((name, needed))
        })
    }
}
