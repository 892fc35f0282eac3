//! Uncorrected volumes with a time beside each value: RENADIC and BHRC.

use rocking_records::{Format, ReadOptions, Unit};

use super::super::{accelerations, refusal};
use super::{COUNT, assert_values, block, channel, doubt, wave};

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
fn renadic_channels_of_pairs_are_read() {
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
        "made-up, line 11: found 40 values in the file, expected 41, the header's NO. OF POINTS"
    );
    assert_eq!(
        doubt(&text.replace("MAX  = -0.051", "MAX  = -0.061"), &channel("1")).unwrap(),
        "the peak of the values is 0.505 g/10, and line 12 states 0.61 g/10"
    );
    let cut: String = text.lines().take(28 + 8 + 28).map(|line| format!("{line}\n")).collect();
    assert_eq!(
        refusal(&cut, &channel("Z")),
        "made-up, line 47: found 5 values in the file, expected 40, the header's NO. OF POINTS"
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
fn bhrc_channels_are_read() {
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
        "made-up, line 11: found 30 values in the file, expected 40, the header's NO. OF POINTS"
    );
    let message = refusal(&text.replacen("  .200000E+03", "  .000000E+00", 1), &channel("L"));
    assert!(
        message.starts_with("made-up, line 22: found \".000000E+00  .000000E+00\", expected the sampling rate"),
        "{message}"
    );
    let message = refusal(&text.replacen("SECONDS AND G/10", "SECONDS", 1), &channel("L"));
    assert!(message.ends_with("expected a BHRC file, with units as SECONDS AND G/10"), "{message}");
}
