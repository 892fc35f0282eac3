//! Formats of national networks: short made-up files in their layouts, intact, damaged and cut off.

use std::fmt::Write;

use rocking_records::{Choice, Format, ReadOptions, Record, Unit, parse_with_doubt};

use super::{accelerations, parsed, refusal};

/// Count of values of most files below.
const COUNT: usize = 40;

/// A decaying oscillation, with its peak at the third value.
pub fn wave(count: usize, peak: f64) -> Vec<f64> {
    let shape = [0.0, 0.5, 1.0, 0.25, -0.5, -0.75];
    (0..count).map(|i| peak * shape[i % 6] / (1.0 + (i / 6) as f64)).collect()
}

/// Prints values in columns of a width, as Fortran does.
pub fn block(values: &[f64], columns: usize, width: usize, decimals: usize) -> String {
    let lines = values
        .chunks(columns)
        .map(|row| row.iter().map(|value| format!("{value:width$.decimals$}")).collect::<String>());
    lines.map(|line| line + "\n").collect()
}

/// Options that choose a channel.
pub fn channel(text: &str) -> ReadOptions {
    ReadOptions { channel: Some(text.parse().unwrap()), ..ReadOptions::default() }
}

fn doubt(text: &str, options: &ReadOptions) -> Option<String> {
    parse_with_doubt("made-up", text.as_bytes(), options).unwrap_or_else(|error| panic!("{error}")).1
}

#[track_caller]
fn assert_values(record: &Record, expected: &[f64], tolerance: f64) {
    assert_eq!(record.acceleration.len(), expected.len());
    for (index, (found, expected)) in record.acceleration.iter().zip(expected).enumerate() {
        assert!((found - expected).abs() <= tolerance, "value {index}: {found}, expected {expected} m/s²");
    }
}

/// Counts of a mean of 5000 and a peak of 1000 counts.
pub fn knet(direction: &str) -> String {
    let counts: Vec<f64> = wave(COUNT, 1000.0).iter().map(|count| (5000.0 + count).round()).collect();
    let mean = counts.iter().sum::<f64>() / COUNT as f64;
    let peak = counts.iter().map(|count| (count - mean).abs()).fold(0.0, f64::max) * 2000.0 / 8_388_608.0;
    format!(
        "Origin Time       2001/02/03 04:05:00\nLat.              41.0\nLong.             142.5\nDepth. (km)       30\n\
         Mag.              6.2\nStation Code      XYZ001\nStation Lat.      41.5\nStation Long.     140.9\n\
         Station Height(m) 39\nRecord Time       2001/02/03 04:05:43\nSampling Freq(Hz) 100Hz\nDuration Time(s)  0.4\n\
         Dir.              {direction}\nScale Factor      2000(gal)/8388608\nMax. Acc. (gal)   {peak:.3}\n\
         Last Correction   2001/02/03 04:05:43\nMemo.             \n{}",
        block(&counts, 8, 9, 0)
    )
}

#[test]
fn knet_counts_become_gal_about_their_mean() {
    let text = knet("E-W");
    let record = accelerations(&text, &ReadOptions::default());
    assert_eq!((record.format, record.unit, record.time_step), (Format::Knet, Unit::CentimetrePerSecondSquared, 0.01));
    assert_eq!(record.title, "XYZ001, 2001/02/03 04:05:00, E-W");
    let counts: Vec<f64> = wave(COUNT, 1000.0).iter().map(|count| (5000.0 + count).round()).collect();
    let mean = counts.iter().sum::<f64>() / COUNT as f64;
    let expected: Vec<f64> = counts.iter().map(|count| (count - mean) * 2000.0 / 8_388_608.0 / 100.0).collect();
    assert_values(&record, &expected, 1e-15);
    assert!(record.acceleration.iter().sum::<f64>().abs() < 1e-12);
    assert_eq!(doubt(&text, &ReadOptions::default()), None);
    // KiK-net numbers its directions.
    assert!(accelerations(&knet("5"), &channel("ew2")).title.ends_with(", EW2"));
    assert_eq!(
        refusal(&text, &channel("N-S")),
        "made-up: found 1 channel (1: E-W), not one \"N-S\"; expected channel 1 or its name"
    );
    // Every line of the header that the values need.
    for key in ["Sampling Freq(Hz)", "Duration Time(s)"] {
        let message = refusal(&text.replace(key, "Something"), &ReadOptions::default());
        assert_eq!(
            message,
            format!("made-up, line 17: found \"the end of the header\", expected a line of {key:?} before it")
        );
    }
    assert_eq!(
        refusal(&text.replace("/8388608", "/0"), &ReadOptions::default()),
        "made-up, line 14: found \"Scale Factor      2000(gal)/0\", expected a scale factor as 3920(gal)/6182761"
    );
    assert_eq!(
        refusal(&text.replace("100Hz", "0Hz"), &ReadOptions::default()),
        "made-up, line 11: found \"0Hz\", expected a sampling rate above 0 Hz, as 100Hz"
    );
    let cut = text.rsplit_once('\n').unwrap().0.rsplit_once('\n').unwrap().0;
    assert_eq!(
        refusal(cut, &ReadOptions::default()),
        "made-up, line 12: header says Duration Time(s) times Sampling Freq(Hz)= 40 but the file has 32 values"
    );
    assert_eq!(
        refusal(&text[..text.len() - 2], &ReadOptions::default()),
        "made-up, line 22: the file ends within the number \"503\", expected columns of 9 characters as in all numbers before"
    );
    // The file's unit is gal.
    let in_g = ReadOptions { unit: Some(Unit::G), ..ReadOptions::default() };
    assert_eq!(refusal(&text, &in_g), "made-up, line 14: the file is in cm/s² but g was given; expected unit cm/s2");
}

pub fn knet_csv() -> String {
    let mut text = String::from(
        "#K-NET CSV\n#Event\n#OriginTime,Latitude,Longitude,Depth(km),Magnitude\n#2001/02/03 04:05:00,31.7,131.7,31,7.1\n\
         #Station\n#Code,Latitude,Longitude,Height(m)\n#XYZ001,33.9,133.5,25\n#Record\n#SamplingFrequency(Hz)\n#100\n\
         #DurationTime(s)\n#0.4\n#Offset\n#N-S(gal),E-W(gal),U-D(gal)\n#0.10,1.70,16.50\n\
         #Time,RelativeTime(s),N-S(gal),E-W(gal),U-D(gal)\n",
    );
    for (i, value) in wave(COUNT, 12.0).iter().enumerate() {
        writeln!(
            text,
            "2001/02/03 04:05:15.{i:02},0.{i:02},{:.2},{:.2},{:.2}",
            value + 0.1,
            2.0 * value + 1.7,
            3.0 * value + 16.5
        )
        .unwrap();
    }
    text
}

#[test]
fn knet_csv_is_read_without_its_offsets() {
    let text = knet_csv();
    for (name, number, factor) in [("N-S", "1", 1.0), ("e-w", "2", 2.0), ("U-D", "3", 3.0)] {
        let record = accelerations(&text, &channel(name));
        assert_eq!((record.format, record.time_step), (Format::Knet, 0.01));
        assert_values(&record, &wave(COUNT, factor * 0.12), 0.51e-4);
        assert_eq!(record, accelerations(&text, &channel(number)));
    }
    assert_eq!(accelerations(&text, &channel("2")).title, "XYZ001, 2001/02/03 04:05:00, E-W");
    assert_eq!(
        refusal(&text, &ReadOptions::default()),
        "made-up: found 3 channels (1: N-S, 2: E-W, 3: U-D); expected channel 1 to 3 or a name"
    );
    let (cut, _) = text.trim_end().rsplit_once('\n').unwrap();
    assert_eq!(
        refusal(cut, &channel("1")),
        "made-up, line 12: header says #DurationTime(s) times #SamplingFrequency(Hz)= 40 but the file has 39 values"
    );
    // Cut off within the last column, which is not the chosen one.
    assert!(refusal(&text[..text.len() - 2], &channel("1")).contains("the file ends within the number"));
    let message = refusal(&text.replace(",0.17,", ",0.175,"), &channel("1"));
    assert_eq!(message, "made-up, line 34: found time 0.175 s, expected 0.17 s (even steps of 0.01 s)");
    assert_eq!(
        refusal(&text.replace("#Offset", "#Offsets"), &channel("1")),
        "made-up, line 16: found \"the end of the header\", expected a line #Offset before it"
    );
    assert_eq!(
        refusal(&text.replace("E-W(gal)", "E-W(cm/s)"), &channel("2")).split(": ").nth(1).unwrap(),
        "found a velocity in cm/s, expected an acceleration time history"
    );
}

/// The layout of volume 2 since 2008, of two channels.
pub fn csmip_corrected() -> String {
    let channel = |number: usize, name: &str, peak: f64| {
        let header = format!(
            "Corrected accelerogram   12345-L1234-01234.56       Chan  {number}: {name}     from   \n\
             Uncorrected Accelerogram Data             Processed: 02/03/01, XYZ\nRecord of Sat Feb 3, 2001 04:05:00.0 PST\n\
             Preliminary Processing\n12345-L1234-01234.56\nStation No. 12345   41.0N, 123.0W\nSomewhere\n\
             Chan  {number}: {name}        \nRecord of Sat Feb 3, 2001\nHypocenter:\nInstr Period =  .0109 sec\n\
                             Record length =   .400 sec.\n                          Uncor Max  =   .079 g , at   .020 sec.\n\
             RMS accel of (uncor) record  =        .\nAccelerogram bandpass filtered\n    40 points of corrected accel\n\
             At equally-spaced intervals of    .010  sec.\nPeak acceleration = {peak:9.3}    cm/sec/sec  at     .020   sec.\n\
             Peak   velocity   =     3.150      cm/sec    at     .650   sec.\n"
        );
        let values = |decimals| block(&wave(COUNT, peak), 8, 10, decimals);
        format!(
            "{header}    40 points of accel data equally spaced at  .010 sec, in cm/sec2. (8f10.5)    \n{}\
             \u{20}   40 points of veloc data equally spaced at  .010 sec, in cm/sec.  (8f10.7)    \n{}\
             /&  ----------  End of data for channel  {number}  ----------\n",
            values(5),
            values(5)
        )
    };
    channel(1, "360 Deg", -77.25) + &channel(2, " Up", 1020.5)
}

#[test]
fn csmip_since_2008() {
    let text = csmip_corrected();
    for (name, peak) in [("360 deg", -0.7725), ("Up", 10.205)] {
        let record = accelerations(&text, &channel(name));
        assert_eq!(
            (record.format, record.unit, record.time_step),
            (Format::Csmip, Unit::CentimetrePerSecondSquared, 0.01)
        );
        // Values above 1000 touch their neighbours.
        assert_values(&record, &wave(COUNT, peak), 0.51e-7);
        assert_eq!(doubt(&text, &channel(name)), None);
    }
    assert_eq!(
        accelerations(&text, &channel("1")).title,
        "Record of Sat Feb 3, 2001 04:05:00.0 PST; Somewhere; Chan 1: 360 Deg"
    );
    assert_eq!(
        refusal(&text, &channel("90 Deg")),
        "made-up: found 2 channels (1: 360 Deg, 2: Up), not one \"90 Deg\"; expected channel 1 to 2 or a name"
    );
    assert_eq!(
        doubt(&text.replace("  -77.250", "  -87.250"), &channel("1")).unwrap(),
        "the peak of the values is 77.25 cm/s², and line 18 states 87.25 cm/s²"
    );
    let one_less = text.replacen("    40 points of accel", "    41 points of accel", 1);
    assert_eq!(
        refusal(&one_less, &channel("1")),
        "made-up, line 20: header says POINTS= 41 but the file has 40 values"
    );
    let message = refusal(&text.replace("in cm/sec2. (8f10.5)", "in furlongs."), &channel("1"));
    assert!(message.contains("expected a unit as 3251 POINTS"), "{message}");
}

/// A channel of volume 1 from a digital instrument.
pub fn csmip_uncorrected(values: &[f64]) -> String {
    format!(
        "Uncorrected Accelerogram Data             Processed: 02/03/01, XYZ\nRecord of Sat Feb 3, 2001\nPreliminary\n\
         12345-L1234\nStation No. 12345   41.0N, 123.0W\nSomewhere\nChan  1: 360 Deg\nRecord of Sat Feb 3, 2001\nHypocenter:\n\
         Instr Period =  .0109 sec\nNo. of Points =  40  Record Length =   .200 sec   at 200 Samples/sec\n\
         Units of uncor data are sec and g .        Max  =   .079 g , at    .010 sec.\nRMS calc for complete record =        .\n\
         \u{20}   1  100    1\n  .0108814  .6700000\n\
         \u{20}   40 Accelerogram points at 200 pts/sec in units of g .      Format: (8f9.6)  \n{}\
         /&  ----------  End of Data for Channel  1  ----------\n",
        block(values, 8, 9, 6)
    )
}

#[test]
fn csmip_uncorrected_but_evenly_spaced() {
    let none = ReadOptions::default();
    let text = csmip_uncorrected(&wave(COUNT, 0.0791));
    let record = accelerations(&text, &none);
    assert_eq!((record.format, record.unit, record.time_step), (Format::Csmip, Unit::G, 0.005));
    assert_values(&record, &wave(COUNT, 0.0791 * 9.81), 0.51e-6 * 9.81);
    assert_eq!(doubt(&text, &none), None);
    // The older line of digital instruments names no format.
    let older = text.replace(
        "40 Accelerogram points at 200 pts/sec in units of g .      Format: (8f9.6)",
        "40 POINTS OF ACCEL DATA EQUALLY SPACED AT .005 SEC.  (UNITS: G)",
    );
    assert_eq!(accelerations(&older, &none), record);
    let message = refusal(&text.replace("at 200 pts/sec", "at 0 pts/sec"), &none);
    assert_eq!(message, "made-up, line 16: found \"time step inf s\", expected a time step above 0 s");
    assert!(
        refusal(&text.replace("in units of g ", "in units of counts "), &none)
            .contains("found instrument readings in COUNTS")
    );
    assert!(doubt(&text.replace("  .079 g ,", "  .089 g ,"), &none).unwrap().ends_with("and line 12 states 0.089 g"));
}

/// Pairs of a time and an acceleration in g/10, in columns of seven characters.
fn pairs(times: impl Iterator<Item = f64>, values: &[f64]) -> String {
    let pairs: Vec<f64> = times.zip(values).flat_map(|(time, &value)| [time, value]).collect();
    block(&pairs, 10, 7, 3)
}

/// Text lines of a volume 1 with pairs, and lines of integers and reals.
fn header_of_pairs(count: usize, network: &str, name: &str, peak: f64) -> String {
    let numbers = "    0    0\n".repeat(7) + &"     0.000     0.000\n".repeat(7);
    format!(
        "UNCORRECTED ACCELEROGRAM DATA              PROCESSED: 02/03/2001\nSOMEWHERE 2001\n02/03/2001 2:45:26 (GMT)\n\
         TRIGGER TIME: 2/3/2001 2:45:46.000 GMT\nSTATION NO.          0.000N    0.000E  QDR\nSTATION S/N 1\n\
         CHAN  1: {name}       (STA CHN:  1)\n{network}\nHYPOCENTER:\nINSTR PERIOD = 0.0390 SEC\n\
         NO. OF POINTS =   {count}  RECORD LENGTH =  0.400 SEC\n\
         UNITS OF UNCOR ACCEL ARE SEC AND G/10.     MAX  = {peak:.3} G, AT   0.020 SEC\nRMS ACCEL OF COMPLETE RECORD = 0.006 G\n{numbers}"
    )
}

pub fn renadic() -> String {
    let times = |count: usize| (0..count).map(|i| 99.9 + 0.01 * i as f64);
    let channel = |number: usize, name: &str, peak: f64| {
        let header = header_of_pairs(COUNT, "UNIVERSIDAD DE CHILE - RENADIC", name, peak / 10.0);
        let values = pairs(times(COUNT), &wave(COUNT, peak));
        format!("{header}{values}/&  ----------  END OF DATA FOR CHANNEL {number}  ----------\n")
    };
    channel(1, "EW", -0.505) + &channel(2, "Z", 0.304)
}

#[test]
fn renadic_pairs() {
    let text = renadic();
    for (name, peak) in [("EW", -0.505), ("z", 0.304)] {
        let record = accelerations(&text, &channel(name));
        // Times of seven characters touch the value before them.
        assert_eq!((record.format, record.unit), (Format::Renadic, Unit::TenthOfG));
        assert_eq!((record.start_time, record.time_step), (99.9, 0.01));
        assert_values(&record, &wave(COUNT, 0.981 * peak), 0.51e-3 * 0.981);
        assert_eq!(doubt(&text, &channel(name)), None);
    }
    assert_eq!(accelerations(&text, &channel("1")).title, "SOMEWHERE 2001; STATION S/N 1; CHAN 1: EW (STA CHN: 1)");
    assert_eq!(
        refusal(&text.replacen("NO. OF POINTS =   40", "NO. OF POINTS =   41", 1), &channel("1")),
        "made-up, line 11: header says NO. OF POINTS= 41 but the file has 40 values"
    );
    assert_eq!(
        doubt(&text.replace("MAX  = -0.051", "MAX  = -0.061"), &channel("1")).unwrap(),
        "the peak of the values is 0.505 g/10, and line 12 states 0.61 g/10"
    );
    let cut: String = text.lines().take(28 + 8 + 28).map(|line| format!("{line}\n")).collect();
    assert_eq!(
        refusal(&cut, &channel("Z")),
        "made-up, line 47: header says NO. OF POINTS= 40 but the file has 5 values"
    );
    let within_a_pair = refusal(text.rsplit_once("  0.0").unwrap().0, &channel("Z"));
    assert!(
        within_a_pair.contains("expected pairs of a time and an acceleration, 7 characters each"),
        "{within_a_pair}"
    );
}

/// Times of digitized film are refused at the place where they differ most, and only if they are uneven.
#[test]
fn uneven_pairs_are_refused_for_that_reason() {
    let file = |times: Vec<f64>| {
        header_of_pairs(times.len(), "SOMEWHERE", "90 DEG", 0.05) + &pairs(times.into_iter(), &wave(COUNT, 0.5))
    };
    let even = accelerations(&file((0..COUNT).map(|i| 0.02 * i as f64).collect()), &ReadOptions::default());
    assert_eq!((even.format, even.time_step), (Format::Csmip, 0.02));
    // Times to 1 ms of steps of 4 ms, with a gap of 8 ms after the 20th.
    let film = file((0..COUNT).map(|i| 0.00425 * i as f64 + if i < 20 { 0.0 } else { 0.008 }).collect());
    assert_eq!(
        refusal(&film, &ReadOptions::default()),
        "made-up, line 32: found an uncorrected accelerogram (volume 1) whose times are not evenly spaced: 0.102 s, where steps of \
         0.004462 s give 0.098 s, which is not supported; expected the corrected record (volume 2)"
    );
}

pub fn bhrc() -> String {
    let channel = |name: &str, peak: f64| {
        let integers = "    0    0\n".repeat(7);
        let rates =
            "  .188324E-01  .640000E+00\n  .200000E+03  .000000E+00\n".to_owned() + &"  .000000E+00\n".repeat(5);
        let values: String = wave(COUNT, peak)
            .chunks(10)
            .map(|row| row.iter().map(|value| format!("{:>13}", format!("{value:.6E}"))).collect::<String>() + "\n")
            .collect();
        format!(
            "* VOL1DS FILE:  0001/01\nInst Type = SSA-2\nOrigin Time : 2001/02/03   12:23:16\n\n{name}\n      \nCOMP {name}1\n\
             Somewhere                 Station   38.4 N 47.0 E   Altitude 1360m\nEpicenter 38.5 N\nINSTR PERIOD =  .019 SEC\n\
             NO. OF POINTS =  40      DURATION =    .200\nUNITS ARE SECONDS AND G/10\n      \n{integers}{rates}{values}/&\n"
        )
    };
    channel("L", 1.25) + &channel("V", -0.5)
}

#[test]
fn bhrc_channels() {
    let text = bhrc();
    for (name, peak) in [("L", 1.25), ("V", -0.5)] {
        let record = accelerations(&text, &channel(name));
        assert_eq!((record.format, record.unit, record.time_step), (Format::Bhrc, Unit::TenthOfG, 0.005));
        assert_values(&record, &wave(COUNT, 0.981 * peak), 1e-6);
    }
    assert!(
        accelerations(&text, &channel("V")).title.starts_with("Origin Time : 2001/02/03 12:23:16; COMP V1; Somewhere")
    );
    let (cut, _) = text.split_once("/&").unwrap();
    assert_eq!(
        refusal(&(cut.trim_end().rsplit_once('\n').unwrap().0.to_owned() + "\n/&\n"), &ReadOptions::default()),
        "made-up, line 11: header says NO. OF POINTS= 40 but the file has 30 values"
    );
    let message = refusal(&text.replacen("  .200000E+03", "  .000000E+00", 1), &channel("L"));
    assert!(
        message.starts_with("made-up, line 22: found \".000000E+00  .000000E+00\", expected the sampling rate"),
        "{message}"
    );
    let message = refusal(&text.replacen("SECONDS AND G/10", "SECONDS", 1), &channel("L"));
    assert!(message.ends_with("expected a BHRC file, with units as SECONDS AND G/10"), "{message}");
}

pub fn usc() -> String {
    let text = [
        "CORRECTED ACCELEROGRAM  IIBB127  94.610.0 COMP N08W   FILE   0  CORRESPONDING T",
        "FILE     0 OF UNCORRECTED ACCELEROGRAM DATA OF VOLUME I:                        ",
        "SOMEWHERE EARTHQUAKE                                                    20      ",
        "FEB 3, 2001 -1230 GMT",
        "IBB127  94.610.0 N",
        "STATION USC# 0001   34 17 11N, 118 13 31W",
        "A STATION",
        "COMP N08W                                                               9       ",
    ];
    format!(
        "{}\nPEAK ACCELERATION =  -242.12345  CMS/SEC/SEC AT    0.040   SEC.\n\
         \u{20}   40 POINTS OF ACC DATA EQUALLY SPACED AT   .020 SEC.  IN UNITS CM/SEC/SEC\n{}",
        text.join("\n"),
        block(&wave(COUNT, -242.123), 8, 10, 3)
    )
}

#[test]
fn usc_volume_two() {
    let text = usc();
    let record = accelerations(&text, &ReadOptions::default());
    assert_eq!((record.format, record.unit, record.time_step), (Format::Usc, Unit::CentimetrePerSecondSquared, 0.02));
    assert_values(&record, &wave(COUNT, -2.42123), 0.51e-5);
    assert_eq!(record.title, "SOMEWHERE EARTHQUAKE; A STATION; COMP N08W");
    // Values have three decimals, their peak five.
    assert_eq!(doubt(&text, &ReadOptions::default()), None);
    assert!(doubt(&text.replace("-242.12345", "-243.12345"), &ReadOptions::default()).is_some());
    // Older files state the unit at the peak only.
    assert_eq!(accelerations(&text.replace("IN UNITS CM/SEC/SEC", ""), &ReadOptions::default()), record);
    let cut = text.trim_end().rsplit_once('\n').unwrap().0;
    assert_eq!(
        refusal(cut, &ReadOptions::default()),
        "made-up, line 10: header says POINTS= 40 but the file has 32 values"
    );
}

pub fn geonet(velocities: usize) -> String {
    let component = |name: &str, peak: f64| {
        let kind = if velocities > 0 { "Corrected" } else { "Uncorrected" };
        let step = match velocities {
            0 => "Raw readings in units of 1.00 mm/s/s  at intervals of 0.005 s",
            _ => "Instrument corrected data at 0.005 sec intervals",
        };
        let counts = [0, 0, 0, COUNT, velocities, velocities, 0, 0, 0, 0].map(|count| format!("{count:8}")).concat();
        let reals = "     0.0     0.0\n".repeat(6);
        format!(
            "{kind} accelerogram 20010203_XYZ_20 GNS Science\nSite XYZ\nSomewhere Centre\nInstrument\nResolution\nAccelerogram\n\
             5 km south\n2001 February 3         11:02:56 UT\nEpicentre\nNumber of points  40    Duration 0.20 s\n{step}\nData\n\
             Component {name}  Accelerometer Axis\nAcceleration:  Peak   {peak:.1} mm/s/s at  0.01 s\nVelocity\nDisplacement\n\
             {0}{0}{0}{counts}\n{reals}{1}{2}{2}",
            "       0       0\n",
            block(&wave(COUNT, peak), 10, 8, 1),
            block(&vec![7.0; velocities], 10, 8, 3),
        )
    };
    component("N10E", -23940.5) + &component("Up", 1589.9)
}

#[test]
fn geonet_volumes() {
    for velocities in [0, 25] {
        let text = geonet(velocities);
        for (name, peak) in [("n10e", -23.9405), ("Up", 1.5899)] {
            let record = accelerations(&text, &channel(name));
            assert_eq!((record.format, record.unit), (Format::Geonet, Unit::MillimetrePerSecondSquared));
            assert_eq!(record.time_step, 0.005);
            assert_values(&record, &wave(COUNT, peak), 0.51e-4);
            assert_eq!(doubt(&text, &channel(name)), None);
        }
        assert!(
            accelerations(&text, &channel("2"))
                .title
                .starts_with("Somewhere Centre; 2001 February 3 11:02:56 UT; Component Up")
        );
        assert_eq!(
            doubt(&text.replace("Peak   1589.9", "Peak   1590.9"), &channel("Up")).unwrap(),
            "the peak of the values is 1589.9 mm/s², and line 44 states 1590.9 mm/s²"
                .replace("44", if velocities > 0 { "50" } else { "44" })
        );
    }
    let text = geonet(0);
    let first: String = text.lines().take(28).map(|line| format!("{line}\n")).collect();
    assert_eq!(
        refusal(&first, &ReadOptions::default()),
        "made-up, line 20: header says 4th integer= 40 but the file has 20 values"
    );
    assert!(refusal(&text.replace(" s\n", " hours\n"), &channel("1")).contains("expected a time step as 0.005 s"));
    assert!(
        refusal(&text.replace("mm/s/s at  0.01", "mm/s at  0.01"), &channel("1")).contains("found a velocity in mm/s")
    );
}

pub fn nsmn() -> String {
    let mut text = String::from(
        "STRONG GROUND MOTION RECORDS OF TURKIYE\nPLACE                   : SOMEWHERE\nEARTHQUAKE DATE         : 2001/02/03 22:31:09 (GMT)\n\
         STATION ID              : 0001\nNUMBER OF DATA          : 40\nSAMPLING INTERVAL (sec) : 0.01\n\
         RAW PGA VALUES (gal)    : (N-S) 13.500000 (E-W) 27.000000 (U-D) 40.500000\nCopyright EARTHQUAKE DEPARTMENT\n\
         \u{20}      N-S          E-W          U-D\n",
    );
    for value in wave(COUNT, -13.5) {
        writeln!(text, "{:12.6} {:12.6} {:12.6}", value, 2.0 * value, 3.0 * value).unwrap();
    }
    text
}

#[test]
fn nsmn_components() {
    let text = nsmn();
    for (name, factor) in [("N-S", 1.0), ("E-W", 2.0), ("U-D", 3.0)] {
        let record = accelerations(&text, &channel(name));
        assert_eq!(
            (record.format, record.unit, record.time_step),
            (Format::Nsmn, Unit::CentimetrePerSecondSquared, 0.01)
        );
        assert_values(&record, &wave(COUNT, -0.135 * factor), 0.51e-8);
        assert_eq!(record.title, format!("SOMEWHERE, 2001/02/03 22:31:09 (GMT), 0001, {name}"));
        assert_eq!(doubt(&text, &channel(name)), None);
    }
    assert_eq!(
        doubt(&text.replace("27.000000 (U", "28.000000 (U"), &channel("2")).unwrap(),
        "the peak of the values is 27 cm/s², and line 7 states 28 cm/s²"
    );
    let cut = text.trim_end().rsplit_once('\n').unwrap().0;
    assert_eq!(
        refusal(cut, &channel("1")),
        "made-up, line 5: header says NUMBER OF DATA= 40 but the file has 39 values"
    );
    let (row, _) = text.trim_end().rsplit_once(' ').unwrap();
    assert_eq!(refusal(row, &channel("1")), "made-up, line 49: found \"2 columns\", expected a row of 3 columns");
}

pub fn unam(rows: usize) -> String {
    let mut text = String::from(
        "********************\n   INSTITUTO DE INGENIERIA, UNAM\n********************\nARCHIVO ESTANDAR DE ACELERACION:\n\
         VERSION DEL FORMATO                    : 2.0\nNOMBRE DE LA ESTACION                  : ALGUN LUGAR\n\
         NUMERO DE CANALES                      : 3\nORIENTACION C1-C6 (rumbo;orientacion)  : /V/N00E/N90E\n\
         ORIENTACION C7-C12 (rumbo;orientacion) : \nINTERVALO DE MUESTREO, C1-C6 (s)       : /0.005/0.005/0.005\n\
         INTERVALO DE MUESTREO, C7-C12 (s)      : \nFECHA DEL SISMO [GMT]                  : 2001/02/03\n\
         NUM. TOTAL DE MUESTRAS, C1-C6          : /40/40/40\nNUM. TOTAL DE MUESTRAS, C7-C12         : \n\
         ACEL. MAX.(Gal), C1-C6                 : /25.6/51.2/-76.8\nACEL. MAX., C1-C6, EN LA MUESTRA       : /3/3/3\n\
         ACEL. MAX.(Gal), C7-C12                : \nUNIDADES DE LOS DATOS                  : Gal (cm/s/s)\n\
         FACTOR DE DECIMACION                   : 1\nFORMATO DATOS (FORTRAN,10 campos/dato) : 3F10.4\n========\n\
         DATOS DE ACELERACION:\n---------+---------+---------+\n   CANAL-1   CANAL-2   CANAL-3\n\
         \u{20}        V      N00E      N90E\n---------+---------+---------+\n",
    );
    for value in wave(rows, 25.6) {
        text += &block(&[value, 2.0 * value, -3.0 * value], 3, 10, 4);
    }
    text
}

#[test]
fn unam_channels() {
    let text = unam(COUNT);
    for (name, factor) in [("V", 1.0), ("N00E", 2.0), ("n90e", -3.0)] {
        let record = accelerations(&text, &channel(name));
        assert_eq!(
            (record.format, record.unit, record.time_step),
            (Format::Unam, Unit::CentimetrePerSecondSquared, 0.005)
        );
        assert_values(&record, &wave(COUNT, 0.256 * factor), 0.51e-6);
        assert_eq!(doubt(&text, &channel(name)), None);
    }
    assert_eq!(accelerations(&text, &channel("2")).title, "ALGUN LUGAR, 2001/02/03, N00E");
    assert_eq!(
        refusal(&text, &ReadOptions::default()),
        "made-up: found 3 channels (1: V, 2: N00E, 3: N90E); expected channel 1 to 3 or a name"
    );
    // Rows that repeat the last one are left out with a warning, missing ones are not guessed.
    let longer = unam(COUNT + 2);
    assert_eq!(doubt(&longer, &channel("V")).unwrap(), "line 13 states 40 values; 2 after them are left out");
    assert_eq!(accelerations(&longer, &channel("V")), accelerations(&text, &channel("V")));
    for rows in [COUNT - 1, COUNT + 3] {
        let message =
            format!("made-up, line 13: header says NUM. TOTAL DE MUESTRAS= 40 but the file has {rows} values");
        assert_eq!(refusal(&unam(rows), &channel("V")), message);
    }
    assert!(
        doubt(&text.replace("/51.2/", "/52.2/"), &channel("2")).unwrap().ends_with("and line 15 states 52.2 cm/s²")
    );
    assert_eq!(
        refusal(&text.replace("DECIMACION                   : 1", "DECIMACION                   : 2"), &channel("1")),
        "made-up, line 19: found \"2\", expected a factor of decimation of 1"
    );
    assert_eq!(
        refusal(
            &text.replace("NUMERO DE CANALES                      : 3", "NUMERO DE CANALES                      : 4"),
            &channel("1")
        ),
        "made-up, line 7: found \"4 channels\", expected 3 as in ORIENTACION"
    );
    assert!(
        refusal(&text.replace("UNIDADES", "UNIDADEZ"), &channel("1"))
            .contains("expected a line UNIDADES DE LOS DATOS before it")
    );
}

pub fn jma() -> String {
    let mut text = String::from(
        "SITE CODE= 47675大島町,34.7,139.3,,\n LAT.=  34.7488\n LON.=  139.3628\n SAMPLING RATE= 100Hz\n UNIT  = gal(cm/s/s)\n\
         INITIAL TIME = 2001 02 03 07 58 13\nNS,EW,UD\n",
    );
    for value in wave(COUNT, 4.5) {
        writeln!(text, "{:8.3},{:8.3},{:8.3}", value, -2.0 * value, 3.0 * value).unwrap();
    }
    text
}

#[test]
fn jma_components() {
    let text = jma();
    for (name, factor) in [("NS", 1.0), ("EW", -2.0), ("UD", 3.0)] {
        let record = accelerations(&text, &channel(name));
        assert_eq!(
            (record.format, record.unit, record.time_step),
            (Format::Jma, Unit::CentimetrePerSecondSquared, 0.01)
        );
        assert_values(&record, &wave(COUNT, 0.045 * factor), 0.51e-5);
        assert_eq!(record.title, format!("47675大島町, 2001 02 03 07 58 13, {name}"));
    }
    assert_eq!(
        refusal(&text, &ReadOptions::default()),
        "made-up: found 3 channels (1: NS, 2: EW, 3: UD); expected channel 1 to 3 or a name"
    );
    // No count: a file that is cut off shows in its last row only.
    assert!(refusal(&text[..text.len() - 2], &channel("NS")).contains("the file ends within the number"));
    assert!(refusal(text.trim_end().rsplit_once(',').unwrap().0, &channel("NS")).contains("found \"2 columns\""));
    assert_eq!(
        refusal(&text.replace("gal(cm/s/s)", "count"), &channel("NS")),
        "made-up, line 5: found instrument readings in count, expected an acceleration time history"
    );
    assert_eq!(
        refusal(&text.replace("NS,EW,UD\n", ""), &channel("NS")),
        "made-up, line 7: found \"0.000,  -0.000,   0.000\", expected the names of the components, as NS,EW,UD"
    );
    // Shift-JIS, as the agency writes it.
    let (before, after) = text.split_once("大島町").unwrap();
    let bytes = [before.as_bytes(), b"\x91\xE5\x93\x87\x92\xAC", after.as_bytes()].concat();
    assert_eq!(
        rocking_records::parse("jma", &bytes, &channel("NS")).unwrap().acceleration,
        accelerations(&text, &channel("NS")).acceleration
    );
}

pub fn cwb() -> String {
    let mut text = String::from(
        "#Earthquake Information\r\n#Origin Time(GMT+08): 2001/02/03-23:50:42\r\n\r\n#Station Information\r\n#StationCode: XYZ\r\n\
         #StationName: Somewhere\r\n#StartTime(GMT+08): 2001/02/03-23:50:29.000\r\n#RecordLength(sec): 0.4\r\n#SampleRate(Hz): 100\r\n\
         #AmplitudeUnit:  gal. DCoffset(corr)\r\n#AmplitudeMAX. U:    6.000~   -4.500\r\n#AmplitudeMAX. N:    9.000~  -12.000\r\n\
         #AmplitudeMAX. E:   18.000~  -13.500\r\n#DataSequence: Time U(+); N(+); E(+)\r\n#Data: 4F10.3 \r\n",
    );
    for (i, value) in wave(COUNT, 6.0).iter().enumerate() {
        text += &block(&[0.01 * i as f64, *value, -2.0 * value, 3.0 * value], 4, 10, 3).replace('\n', "\r\n");
    }
    text
}

#[test]
fn cwb_components() {
    let text = cwb();
    for (name, factor) in [("U", 1.0), ("n", -2.0), ("E", 3.0)] {
        let record = accelerations(&text, &channel(name));
        assert_eq!(
            (record.format, record.unit, record.time_step),
            (Format::Cwb, Unit::CentimetrePerSecondSquared, 0.01)
        );
        assert_values(&record, &wave(COUNT, 0.06 * factor), 0.51e-5);
        assert_eq!(doubt(&text, &channel(name)), None);
    }
    assert_eq!(accelerations(&text, &channel("E")).title, "XYZ, Somewhere, 2001/02/03-23:50:29.000, E");
    assert!(
        doubt(&text.replace("-12.000\r\n#A", "-12.500\r\n#A"), &channel("N"))
            .unwrap()
            .ends_with("and line 12 states 12.5 cm/s²")
    );
    let cut = text.trim_end().rsplit_once('\n').unwrap().0;
    assert_eq!(
        refusal(cut, &channel("U")),
        "made-up, line 8: header says #RecordLength(sec) times #SampleRate(Hz)= 40 but the file has 39 values"
    );
    let uneven = refusal(&text.replace("     0.170  ", "     0.175  "), &channel("U"));
    assert_eq!(uneven, "made-up, line 33: found time 0.175 s, expected 0.17 s (even steps of 0.01 s)");
    assert!(
        refusal(&text.replace("#SampleRate", "#Rate"), &channel("U"))
            .contains("expected a line #SampleRate(Hz): 100 before it")
    );
}

/// The Turkish agency writes DYNA 1.2 with a data type in mixed case.
pub fn afad() -> String {
    let values: String = wave(COUNT, 1.632).iter().map(|value| format!("{value:.6}\n")).collect();
    format!(
        "EVENT_NAME: 200102030405\nNETWORK: TK\nSTATION_CODE: 0001\nSTATION_NAME: \nSAMPLING_INTERVAL_S: 0.01\nNDATA: 40\nSTREAM: HNE\n\
         UNITS: cm/s^2\nPGA_CM/S^2: 1.632\nHEADER_FORMAT: DYNA 1.2\nDATA_TYPE: Acceleration\nUSER5: \n\n{values}"
    )
}

#[test]
fn afad_is_read_as_dyna() {
    let none = ReadOptions::default();
    let record = accelerations(&afad(), &none);
    assert_eq!((record.format, record.unit, record.time_step), (Format::Esm, Unit::CentimetrePerSecondSquared, 0.01));
    assert_values(&record, &wave(COUNT, 0.01632), 0.51e-8);
    assert_eq!(doubt(&afad(), &none), None);
    assert_eq!(
        doubt(&afad().replace("S^2: 1.632", "S^2: 1.732"), &none).unwrap(),
        "the peak of the values is 1.632 cm/s², and line 9 states 1.732 cm/s²"
    );
    assert!(
        refusal(&afad().replace(": Acceleration", ": Velocity"), &none)
            .contains("expected an acceleration time history")
    );
}

/// All files of this module, each with a channel.
pub fn all() -> [(Format, String, &'static str); 14] {
    [
        (Format::Knet, knet("E-W"), "1"),
        (Format::Knet, knet_csv(), "E-W"),
        (Format::Csmip, csmip_corrected(), "Up"),
        (Format::Csmip, csmip_uncorrected(&wave(COUNT, 0.0791)), "1"),
        (Format::Renadic, renadic(), "Z"),
        (Format::Bhrc, bhrc(), "V"),
        (Format::Usc, usc(), ""),
        (Format::Geonet, geonet(0), "Up"),
        (Format::Geonet, geonet(25), "Up"),
        (Format::Nsmn, nsmn(), "U-D"),
        (Format::Unam, unam(COUNT), "N90E"),
        (Format::Jma, jma(), "UD"),
        (Format::Cwb, cwb(), "E"),
        (Format::Esm, afad(), ""),
    ]
}

/// Options that choose a channel, if the file has several.
pub fn options_of(name: &str) -> ReadOptions {
    ReadOptions { channel: (!name.is_empty()).then(|| name.parse::<Choice>().unwrap()), ..ReadOptions::default() }
}

/// The content alone leads to the format, also when a reader of another format would accept the file.
#[test]
fn each_file_has_one_format() {
    for (format, text, name) in all() {
        assert_eq!(parsed(&text, &options_of(name)).unwrap().format, format);
        // A table of times and accelerations is not read from a header line of its own.
        let commented: String = text.lines().map(|line| format!("// {line}\n")).collect();
        assert!(parsed(&commented, &options_of(name)).is_err(), "{format}");
    }
}
