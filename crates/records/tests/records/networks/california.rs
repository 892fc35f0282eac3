//! Volumes of CSMIP and USC.

use rocking_records::{Format, ReadOptions, Unit};

use super::super::{accelerations, refusal};
use super::{COUNT, assert_values, block, channel, doubt, wave};

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
        "made-up, line 20: found 40 values in the file, expected 41, the header's POINTS"
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
        "made-up, line 10: found 32 values in the file, expected 40, the header's POINTS"
    );
}
