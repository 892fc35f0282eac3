//! The names and titles of records → the ground motions to which they belong.

use std::collections::HashMap;
use std::fmt;

use rocking_block::excitation::records::{Ground, fingerprint};
use rocking_records::{Format, Record};

/// A ground motion: the shaking of one event at one station.
///
/// Its components and their rotations, its processed forms, the floors of a building above it, and the same record with and without a
/// vertical component are one motion, since none of them is independent of the others.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Motion(String);

/// Event and station, as far as the record names them.
impl fmt::Display for Motion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl Motion {
    /// The motion of a horizontal and a vertical record with these names, of which either may be empty. `None` without both.
    pub fn of_names([horizontal, vertical]: [&str; 2]) -> Option<Motion> {
        let name = if horizontal.is_empty() { vertical } else { horizontal };
        (!name.is_empty()).then(|| Motion(EventAndStation::of(name).text))
    }

    /// The motion of a record with its name in tables, and that of its file.
    ///
    /// A title that names event, station and component decides, then a file with several channels of one station, then the name.
    pub fn of_record(record: &Record, name: &str, file: &str) -> Motion {
        let EventAndStation { text, names_component } = EventAndStation::of(&record.title);
        match record.format {
            _ if names_component => Motion(text),
            Format::Columns | Format::Fixed | Format::Peer => Motion(EventAndStation::of(name).text),
            _ => Motion(file.into()),
        }
    }

    /// The motions of all grounds with the names of their records and of their files, by title and content.
    pub fn of_grounds<'a>(
        grounds: impl Iterator<Item = (&'a Ground, &'a [String; 2], &'a [String; 2])>,
    ) -> Vec<Motion> {
        let mut of_content: HashMap<String, Motion> = HashMap::new();
        let motion = |(ground, names, files): (&Ground, &[String; 2], &[String; 2])| {
            let slot = usize::from(ground.horizontal.is_none());
            let record = if slot == 0 { ground.horizontal.as_ref() } else { ground.vertical.as_ref() };
            let Some(record) = record else { return Motion(String::new()) };
            let of_record = || Motion::of_record(record, &names[slot], &files[slot]);
            of_content.entry(fingerprint(record)).or_insert_with(of_record).clone()
        };
        grounds.map(motion).collect()
    }
}

/// Words of motions for a column of tables. `None` if the names of the records, horizontal and vertical, tell the motions as well.
pub fn column<'a>(motions: &'a [Motion], names: impl Iterator<Item = [&'a str; 2]>) -> Option<Vec<String>> {
    let by_name: Vec<Option<Motion>> = names.map(Motion::of_names).collect();
    let first = |all: &[Option<&Motion>], i: usize| all.iter().position(|other| *other == all[i]);
    let motions: Vec<Option<&Motion>> =
        motions.iter().map(|motion| Some(motion).filter(|of| !of.0.is_empty())).collect();
    let by_name: Vec<Option<&Motion>> = by_name.iter().map(Option::as_ref).collect();
    let is_same = (0..motions.len()).all(|i| first(&motions, i) == first(&by_name, i));
    (!is_same).then(|| motions.iter().map(|motion| motion.map_or_else(String::new, Motion::to_string)).collect())
}

/// A title or name without its component.
struct EventAndStation {
    text: String,
    /// Whether the title names a component beside event and station.
    names_component: bool,
}

impl EventAndStation {
    fn of(title: &str) -> EventAndStation {
        // A rotation is named by both components, of one motion.
        let title = title.split(" rotated by ").next().unwrap_or(title).trim();
        let title = match title.rsplit_once(" (") {
            Some((rest, words)) if words.trim_end_matches(')').split(", ").all(is_processing) => rest,
            _ => title,
        };
        if let Some(station) = without_channel(title) {
            return EventAndStation { text: station, names_component: true };
        }
        let parts: Vec<&str> = title.split([';', ',']).map(str::trim).filter(|part| !part.is_empty()).collect();
        let recorded: Vec<&str> =
            parts.iter().copied().filter(|part| !is_processing(part) && !is_floor(part)).collect();
        let places: Vec<&str> = recorded.iter().copied().filter(|part| !is_component(part)).collect();
        // A name of fewer parts is no event and station: "run, 090" may be one of a hundred.
        let names_component = places.len() >= 2 && places.len() < recorded.len();
        let text = match () {
            () if names_component => places.join(", "),
            () if recorded.len() < parts.len() && !recorded.is_empty() => recorded.join(", "),
            () => title.into(),
        };
        EventAndStation { text, names_component }
    }
}

/// The name of a trace such as `IU.ANMO.00.HNZ 2010-02-27T06:30:00` without the letter of its component.
fn without_channel(title: &str) -> Option<String> {
    let (trace, start) = title.split_once(' ')?;
    let (station, channel) = trace.rsplit_once('.')?;
    let is_trace = station.matches('.').count() == 2 && channel.len() == 3 && channel.is_ascii();
    is_trace.then(|| format!("{station}.{} {start}", &channel[..2]))
}

/// Whether a part of a name says how this program has processed the record.
fn is_processing(part: &str) -> bool {
    ["baseline removed", "band-pass ", "resampled every "].iter().any(|words| part.starts_with(words))
}

/// Whether a part of a name is a floor of a building.
fn is_floor(part: &str) -> bool {
    part.strip_prefix("floor ").is_some_and(|number| number.parse::<u32>().is_ok())
}

/// Whether a part of a title names a component of a record.
fn is_component(part: &str) -> bool {
    const LEADING: [&str; 4] = ["chan", "channel", "comp", "component"];
    const WORDS: [&str; 28] = [
        "n",
        "e",
        "z",
        "x",
        "y",
        "h",
        "h1",
        "h2",
        "v",
        "l",
        "t",
        "ns",
        "sn",
        "ew",
        "we",
        "ud",
        "up",
        "down",
        "dn",
        "dwn",
        "ver",
        "vert",
        "vertical",
        "long",
        "longitudinal",
        "tran",
        "trans",
        "transverse",
    ];
    // Remarks in parentheses follow the component.
    let part = part.split('(').next().unwrap_or_default().trim().to_ascii_lowercase();
    let bare: String = part.chars().filter(|c| *c != '-').collect();
    let without_number = bare.trim_end_matches(|c: char| c.is_ascii_digit());
    // "EW2" is the sensor in a borehole.
    WORDS.contains(&bare.as_str())
        || without_number.len() == 2 && WORDS.contains(&without_number)
        || is_azimuth(&part)
        || is_bearing(&bare)
        || is_seed_channel(&bare)
        || part.split_once([' ', ':', '.']).is_some_and(|(word, _)| LEADING.contains(&word))
}

/// Three digits of an azimuth, or any with its degrees: `090`, `45 DEG`.
fn is_azimuth(part: &str) -> bool {
    let digits = ["degrees", "deg", "°"].iter().find_map(|unit| part.strip_suffix(unit));
    let number = digits.unwrap_or(part).trim();
    let is_long_enough = digits.is_some() || number.len() == 3;
    is_long_enough
        && number.bytes().all(|c| c.is_ascii_digit())
        && number.parse::<u32>().is_ok_and(|angle| angle <= 360)
}

/// A bearing such as `N08W` or `S00E`.
fn is_bearing(part: &str) -> bool {
    let angle = part.strip_prefix(['n', 's']).and_then(|rest| rest.strip_suffix(['e', 'w']));
    angle.is_some_and(|angle| matches!(angle.len(), 1..=2) && angle.bytes().all(|c| c.is_ascii_digit()))
}

/// A channel of SEED: `HNE`, `BHZ`, `HN1`.
fn is_seed_channel(part: &str) -> bool {
    let kinds = ["hbec", "nlgh", "enz123"];
    part.len() == 3 && part.chars().zip(kinds).all(|(letter, known)| known.contains(letter))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motion(name: &str) -> String {
        Motion::of_names([name, ""]).unwrap().to_string()
    }

    /// Titles as the readers of records make them, and their components.
    #[test]
    fn components_of_one_station_are_one_motion() {
        for (title, expected) in [
            ("Northridge-01, 1/17/1994, Rinaldi Receiving Sta, 228", "Northridge-01, 1/17/1994, Rinaldi Receiving Sta"),
            ("Northridge-01, 1/17/1994, Rinaldi Receiving Sta, UP", "Northridge-01, 1/17/1994, Rinaldi Receiving Sta"),
            ("IMPERIAL VALLEY, EL CENTRO ARRAY 6, 230 (USGS STATION 942)", "IMPERIAL VALLEY, EL CENTRO ARRAY 6"),
            ("XYZ001, 2001/02/03 04:05:00, E-W", "XYZ001, 2001/02/03 04:05:00"),
            ("XYZ001, 2001/02/03 04:05:00, EW2", "XYZ001, 2001/02/03 04:05:00"),
            ("ALGUN LUGAR, 2001/02/03, N00E", "ALGUN LUGAR, 2001/02/03"),
            ("SOMEWHERE 2001; STATION S/N 1; CHAN 1: EW (STA CHN: 1)", "SOMEWHERE 2001, STATION S/N 1"),
            ("Origin Time : 2001/02/03 12:23:16; COMP V1; Somewhere", "Origin Time : 2001/02/03 12:23:16, Somewhere"),
            ("EVENT, IT, ABC, Place, HNE", "EVENT, IT, ABC, Place"),
            ("IU.ANMO.00.HNZ 2010-02-27T06:30:00", "IU.ANMO.00.HN 2010-02-27T06:30:00"),
        ] {
            assert_eq!(motion(title), expected, "{title}");
        }
    }

    /// What this program makes of a record is no motion of its own.
    #[test]
    fn rotations_floors_and_processed_records_are_one_motion() {
        for name in [
            "quake rotated by 30 degrees towards other",
            "quake; baseline removed, band-pass 0.1 to 25 Hz",
            "quake; resampled every 0.01 s",
            "quake (baseline removed)",
            "quake, floor 3",
        ] {
            assert_eq!(motion(name), "quake", "{name}");
        }
        assert_eq!(Motion::of_names(["h", "v"]), Motion::of_names(["h", ""]));
        assert_ne!(Motion::of_names(["", "v"]), Motion::of_names(["h", "v"]));
        assert_eq!(Motion::of_names(["", ""]), None);
    }

    /// A name that is no event and station stays: a hundred runs are not one motion.
    #[test]
    fn names_without_a_station_stay() {
        for name in
            ["run, 090", "r1", "simulation 3, 12", "two.csv (column a)", "quake (crc32 0123abcd)", "a, b, 1994", "E"]
        {
            assert_eq!(motion(name), name, "{name}");
        }
    }

    #[test]
    fn a_column_says_what_names_do_not() {
        let motions = ["a", "a", "b"].map(|name| Motion::of_names([name, ""]).unwrap());
        let names = |all: [&'static str; 3]| all.into_iter().map(|name| [name, ""]);
        assert_eq!(column(&motions, names(["x", "x", "y"])), None);
        assert_eq!(column(&motions, names(["x", "z", "y"])), Some(vec!["a".into(), "a".into(), "b".into()]));
    }
}
