//! Accelerogram files, and what a user says of them → ground motions.

use crate::records::ground::Ground;
use crate::records::{ReadOptions, Record, RecordError, Setting};

/// What a user says of the files of ground motions.
#[derive(Clone, Debug, Default)]
pub struct Said {
    /// Of horizontal and vertical ones.
    pub of_both: ReadOptions,
    /// Of vertical ones, instead of what is said of both; the gravity of `of_both` counts for them too.
    pub of_vertical: ReadOptions,
}

/// A setting by the name under which a user gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Name {
    /// The setting.
    pub setting: Setting,
    /// Whether it is that of vertical files alone.
    pub vertical: bool,
}

impl Name {
    /// As an option of the command line, such as `--vertical-unit`.
    pub fn option(self) -> String {
        format!("--{}", self.key().replace('_', "-"))
    }

    /// As a key of a study file, such as `vertical_unit`.
    pub fn key(self) -> String {
        let word = match self.setting {
            Setting::Format => "format",
            Setting::Unit => "unit",
            Setting::TimeStep => "dt",
            Setting::Channel => "channel",
            Setting::TimeColumn => "time_column",
            Setting::AccelerationColumn => "acceleration_column",
        };
        format!("{}{word}", if self.vertical { "vertical_" } else { "" })
    }
}

impl Said {
    /// Reads a horizontal or a vertical file by `read`; the error is one line, with settings as `name` calls them.
    pub fn read(
        &self,
        vertical: bool,
        name: impl Fn(Name) -> String,
        read: impl FnOnce(&ReadOptions) -> Result<Record, RecordError>,
    ) -> Result<Record, String> {
        let options = if vertical { self.of_vertical.or(&self.of_both) } else { self.of_both.clone() };
        read(&options).map_err(|error| error.naming(|setting| name(Name { setting, vertical })))
    }

    /// What is said and read from none of these ground motions, and what it needs.
    pub fn unread(&self, grounds: &[Ground]) -> Option<(Name, String)> {
        let horizontal: Vec<&Record> = grounds.iter().filter_map(|ground| ground.horizontal.as_ref()).collect();
        let vertical: Vec<&Record> = grounds.iter().filter_map(|ground| ground.vertical.as_ref()).collect();
        let all = [&horizontal[..], &vertical].concat();
        let of_vertical: Vec<Setting> = self.of_vertical.given().collect();
        let of_both = self.of_both.given().map(|setting| {
            let (files, needed) = match of_vertical.contains(&setting) {
                true => (&horizontal, "a horizontal record"),
                false => (&all, "a record"),
            };
            (Name { setting, vertical: false }, files, needed)
        });
        let of_vertical =
            of_vertical.iter().map(|&setting| (Name { setting, vertical: true }, &vertical, "a vertical record"));
        of_both.chain(of_vertical).find_map(|(name, files, needed)| {
            let formats = name.setting.formats();
            let needed = match files.is_empty() {
                true => needed.into(),
                false => {
                    let words: Vec<String> = formats.iter().map(ToString::to_string).collect();
                    format!("a {} file", words.join(" or "))
                }
            };
            let read = files.iter().any(|record| formats.contains(&record.format));
            (!read).then_some((name, needed))
        })
    }
}
