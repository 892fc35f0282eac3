//! The names and titles of records → the ground motions to which they belong.

use std::collections::HashMap;
use std::fmt;

use rocking_block::excitation::records::{Ground, fingerprint};
use rocking_records::{Format, Record};

/// The column of a table with the motion of each row, where the names of its records do not tell it.
pub const MOTION: &str = "motion";

/// The end of the name of a record that is reversed.
pub const REVERSED: &str = " (reversed)";

/// A ground motion: the shaking of one event at one station.
///
/// Its components and their rotations, both polarities, its processed forms, the floors of a building above it, and the same record with and without a
/// vertical component are one motion, since none of them is independent of the others.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Motion(String);

/// Event and station, as far as the record names them.
impl fmt::Display for Motion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl Motion {
    /// Returns the motion of a horizontal and a vertical record by their names; an empty name stands for no record. `None` without any.
    pub fn of_names([horizontal, vertical]: [&str; 2]) -> Option<Motion> {
        let name = if horizontal.is_empty() { vertical } else { horizontal };
        (!name.is_empty()).then(|| Motion::of_title(name).unwrap_or_else(|| Motion(as_recorded(name))))
    }

    /// The motion of a record with its name in tables, and that of its file.
    ///
    /// A title that names event, station and component decides, then a file with several channels of one station, then the name.
    pub fn of_record(record: &Record, name: &str, file: &str) -> Motion {
        Motion::of_title(&record.title).unwrap_or_else(|| match record.format {
            Format::Columns | Format::Fixed | Format::Peer => Motion(as_recorded(name)),
            _ => Motion(file.into()),
        })
    }

    /// The motions of all grounds with the names of their records and of their files, by title and content.
    pub fn of_grounds<'a>(
        grounds: impl Iterator<Item = (&'a Ground, &'a [String; 2], &'a [String; 2])>,
    ) -> Vec<Motion> {
        Motion::of_all(grounds.map(|(ground, names, files)| {
            let record =
                |record: &'a Option<Record>, slot: usize| Some((record.as_ref()?, &*names[slot], &*files[slot]));
            [record(&ground.horizontal, 0), None, record(&ground.vertical, 1)]
        }))
    }

    /// The motions of components: both horizontal ones and the vertical one, each with its name and that of its file.
    ///
    /// A motion is that of its first component. Horizontal components that occurred before are of the motion in which they did.
    pub fn of_all<'a>(motions: impl Iterator<Item = [Option<(&'a Record, &'a str, &'a str)>; 3]>) -> Vec<Motion> {
        let mut of_content: HashMap<String, Motion> = HashMap::new();
        let motion = |components: [Option<(&Record, &str, &str)>; 3]| {
            let horizontal: Vec<_> = components[..2].iter().flatten().collect();
            let telling = if horizontal.is_empty() { components[2].iter().collect() } else { horizontal };
            let Some((record, name, file)) = telling.first() else { return Motion(String::new()) };
            let contents: Vec<String> = telling.iter().map(|(record, ..)| fingerprint(record)).collect();
            let known = contents.iter().find_map(|content| of_content.get(content)).cloned();
            let motion = known.unwrap_or_else(|| Motion::of_record(record, name, file));
            for content in contents {
                of_content.entry(content).or_insert_with(|| motion.clone());
            }
            motion
        };
        motions.map(motion).collect()
    }

    /// The motion of a title that names event, station and component. `None` if it may leave one of them out: two earthquakes or two
    /// stations must not become one motion, while components that stay two only make intervals as narrow as if they were independent.
    fn of_title(title: &str) -> Option<Motion> {
        let title = as_recorded(title);
        if let Some(station) = without_channel(&title) {
            return Some(Motion(station));
        }
        let mut parts: Vec<&str> = title.split([';', ',']).map(str::trim).filter(|part| !part.is_empty()).collect();
        let last = parts.len().checked_sub(1)?;
        let component = match parts.iter().position(|part| is_component(part)) {
            _ if is_component(parts[last]) || is_azimuth(bare(parts[last])) => last,
            Some(one) if !parts[one + 1..].iter().any(|part| is_component(part)) => one,
            _ => return None,
        };
        parts.remove(component);
        // An event has a name and a day, as PEER writes it, or the time of day beside.
        let is_told = parts.iter().any(|part| is_time(part) || is_american_day(part) && parts.len() >= 3);
        (is_told && parts.len() >= 2).then(|| Motion(parts.join(", ")))
    }
}

/// Words of motions for a column of tables. `None` if the names of the records, horizontal and vertical, tell the motions as well.
pub fn column<'a>(motions: &[Motion], names: impl Iterator<Item = [&'a str; 2]>) -> Option<Vec<String>> {
    let by_name: Vec<String> = names.map(|names| Motion::of_names(names).unwrap_or_default().0).collect();
    let words: Vec<String> = motions.iter().map(Motion::to_string).collect();
    (first_places(&words) != first_places(&by_name)).then_some(words)
}

/// The place of the first equal word, for each word.
fn first_places(words: &[String]) -> Vec<usize> {
    let mut first = HashMap::new();
    words.iter().enumerate().map(|(i, word)| *first.entry(word).or_insert(i)).collect()
}

/// A title or name without the words for what this program makes of a record: rotations, which name both components, floors of a building,
/// and processing.
fn as_recorded(title: &str) -> String {
    let title = title.split(" rotated by ").next().unwrap_or(title).trim();
    let title = title.strip_suffix(REVERSED).unwrap_or(title);
    let title = match title.rsplit_once(" (") {
        Some((rest, words)) if words.trim_end_matches(')').split(", ").all(is_processing) => rest,
        _ => title,
    };
    let is_made = |part: &&str| is_processing(part.trim()) || is_floor(part.trim());
    let Some(end) = title.split_inclusive([';', ',']).position(|part| is_made(&part.trim_end_matches([';', ','])))
    else {
        return title.into();
    };
    // These words are at the end.
    let recorded: String = title.split_inclusive([';', ',']).take(end).collect();
    match recorded.trim_end_matches([';', ',', ' ']) {
        "" => title.into(),
        recorded => recorded.into(),
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
    let part = bare(part).to_ascii_lowercase();
    let word: String = part.chars().filter(|c| *c != '-').collect();
    let without_number = word.trim_end_matches(|c: char| c.is_ascii_digit());
    // "EW2" is the sensor in a borehole.
    WORDS.contains(&word.as_str())
        || without_number.len() == 2 && WORDS.contains(&without_number)
        || is_bearing(&word)
        || is_seed_channel(&word)
        || part.split_once([' ', ':', '.']).is_some_and(|(word, _)| LEADING.contains(&word))
}

/// A part of a title without its remark in parentheses.
fn bare(part: &str) -> &str {
    part.split('(').next().unwrap_or_default().trim()
}

/// Three digits of an azimuth, or any with its degrees: `090`, `45 DEG`. A station or a run may have such a number, too.
fn is_azimuth(part: &str) -> bool {
    let part = part.to_ascii_lowercase();
    let digits = ["degrees", "deg", "°"].iter().find_map(|unit| part.strip_suffix(unit));
    let number = digits.unwrap_or(&part).trim();
    let is_long_enough = digits.is_some() || number.len() == 3;
    is_long_enough
        && number.bytes().all(|c| c.is_ascii_digit())
        && number.parse::<u32>().is_ok_and(|angle| angle <= 360)
}

/// The numbers in a part of a title.
fn numbers(part: &str) -> Vec<&str> {
    part.split(|c: char| !c.is_ascii_digit()).filter(|digits| !digits.is_empty()).collect()
}

/// Whether a part of a title has a day and a time of day: `2001/02/03 04:05:00`, `LOMA PRIETA 10/18/89 00:05`.
fn is_time(part: &str) -> bool {
    let numbers = numbers(part);
    let is_year = |digits: &&str| digits.len() == 4 && (digits.starts_with("19") || digits.starts_with("20"));
    let year = numbers.iter().position(is_year);
    numbers.len() >= 4 && (year.is_some_and(|year| numbers.len() - year >= 4) || is_american_day(part))
}

/// Whether a part of a title has a day, month first: `1/17/1994`, `LOMA PRIETA 10/18/89 00:05`.
fn is_american_day(part: &str) -> bool {
    let is_day = |word: &str| {
        let numbers: Vec<&str> = word.split('/').collect();
        let digits =
            |text: &str, lengths: &[usize]| lengths.contains(&text.len()) && text.bytes().all(|c| c.is_ascii_digit());
        matches!(numbers[..], [month, day, year] if digits(month, &[1, 2]) && digits(day, &[1, 2]) && digits(year, &[2, 4]))
    };
    part.split_whitespace().any(is_day)
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
            (
                "IMPERIAL VALLEY 10/15/79 2319, ARRAY 6, 230 (USGS STATION 942)",
                "IMPERIAL VALLEY 10/15/79 2319, ARRAY 6",
            ),
            ("XYZ001, 2001/02/03 04:05:00, E-W", "XYZ001, 2001/02/03 04:05:00"),
            ("XYZ001, 2001/02/03 04:05:00, EW2", "XYZ001, 2001/02/03 04:05:00"),
            ("XYZ001, 2001/02/03 04:05:00, E-W, floor 2; baseline removed", "XYZ001, 2001/02/03 04:05:00"),
            ("47675大島町, 2001 02 03 07 58 13, N00E", "47675大島町, 2001 02 03 07 58 13"),
            ("SOMEWHERE, 2001/02/03 22:31:09 (GMT), 101, L", "SOMEWHERE, 2001/02/03 22:31:09 (GMT), 101"),
            ("Origin Time : 2001/02/03 12:23:16; COMP V1; Somewhere", "Origin Time : 2001/02/03 12:23:16, Somewhere"),
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
            "quake (reversed)",
            "quake (baseline removed) (reversed)",
            "quake, floor 3",
            "quake, floor 3; baseline removed",
        ] {
            assert_eq!(motion(name), "quake", "{name}");
        }
        assert_eq!(Motion::of_names(["h", "v"]), Motion::of_names(["h", ""]));
        assert_ne!(Motion::of_names(["", "v"]), Motion::of_names(["h", "v"]));
        assert_eq!(Motion::of_names(["", ""]), None);
    }

    /// A name that may leave out the event or the station stays: a hundred runs are not one motion, nor are two shocks of one day.
    #[test]
    fn names_without_event_or_station_stay() {
        for name in [
            "run, 090",
            "run 1",
            "r1",
            "E",
            "a, b, 1994",
            "simulation 3, soil B, 101",
            "Loma Prieta, CA, 090",
            "10/18/1989, Capitola, 090",
            "ALGUN LUGAR, GRO, 2001/02/03, N00E",
            "IT, ABC, Place, HNE",
            "SOMEWHERE 2001; STATION S/N 1; CHAN 1: EW (STA CHN: 1)",
            "Northridge-01, 1/17/1994, Rinaldi Receiving Sta",
            "SOMEWHERE, 2001/02/03 22:31:09, 101, soft",
            "two.csv (column a)",
            "quake (crc32 0123abcd)",
            "floor 3",
        ] {
            assert_eq!(motion(name), name, "{name}");
        }
    }

    /// Files decide for their channels, and content for equal records under two names; files of columns stay.
    #[test]
    fn channels_and_equal_records_are_one_motion() {
        let ground = |title: &str, format, peak: f64| {
            let record = Record {
                title: title.into(),
                format,
                unit: rocking_records::Unit::MetrePerSecondSquared,
                start_time: 0.0,
                time_step: 0.01,
                acceleration: vec![0.0, peak].into(),
                processing: Default::default(),
            };
            Ground { horizontal: Some(record), vertical: None }
        };
        let all = [
            (ground("t", Format::Csmip, 1.0), "s.v2 (channel 1)", "s.v2"),
            (ground("t", Format::Csmip, 2.0), "s.v2 (channel 2)", "s.v2"),
            (ground("t", Format::Columns, 3.0), "c.csv (column a)", "c.csv"),
            (ground("t", Format::Columns, 4.0), "c.csv (column b)", "c.csv"),
            (ground("t", Format::Columns, 4.0), "copy.csv", "copy.csv"),
            (ground("t", Format::Peer, 5.0), "one.at2", "one.at2"),
            (ground("t", Format::Peer, 6.0), "two.at2", "two.at2"),
        ];
        let pair = |text: &str| [text.to_owned(), String::new()];
        let all: Vec<_> = all.map(|(ground, name, file)| (ground, pair(name), pair(file))).into();
        let found = Motion::of_grounds(all.iter().map(|(ground, names, files)| (ground, names, files)));
        let words: Vec<String> = found.iter().map(Motion::to_string).collect();
        assert_eq!(first_places(&words), [0, 0, 2, 3, 3, 5, 6]);
    }

    /// Pairs of one instrument are one motion, whichever of its components comes first.
    #[test]
    fn pairs_with_a_common_component_are_one_motion() {
        let record = |peak: f64| Record {
            title: "t".into(),
            format: Format::Columns,
            unit: rocking_records::Unit::MetrePerSecondSquared,
            start_time: 0.0,
            time_step: 0.01,
            acceleration: vec![0.0, peak].into(),
            processing: Default::default(),
        };
        let [a, b, c] = [1.0, 2.0, 3.0].map(record);
        let pairs = [[(&a, "a"), (&b, "b")], [(&b, "b"), (&a, "a")], [(&c, "c"), (&record(4.0), "d")]];
        let found = Motion::of_all(pairs.iter().map(|[x, y]| [Some((x.0, x.1, x.1)), Some((y.0, y.1, y.1)), None]));
        assert_eq!(found.iter().map(Motion::to_string).collect::<Vec<_>>(), ["a", "a", "c"]);
    }

    #[test]
    fn a_column_says_what_names_do_not() {
        let motions = ["a", "a", "b"].map(|name| Motion::of_names([name, ""]).unwrap());
        let names = |all: [&'static str; 3]| all.into_iter().map(|name| [name, ""]);
        assert_eq!(column(&motions, names(["x", "x", "y"])), None);
        assert_eq!(column(&motions, names(["x", "z", "y"])), Some(vec!["a".into(), "a".into(), "b".into()]));
    }
}
