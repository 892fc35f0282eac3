//! CSMNC of China and the European database.

use rocking_records::{Format, ReadOptions, Unit};

use super::super::{accelerations, refusal, unit_and_step};
use super::{COUNT, assert_values, doubt, wave};

fn rows(values: &[f64]) -> String {
    let row = |row: &[f64]| row.iter().map(|value| format!("{value:13.6E}")).collect::<String>() + " \n";
    values.chunks(8).map(row).collect()
}

pub fn csmnc() -> String {
    format!(
        "001ABC010203000000\n001020300000000 2001-02-03 04:05:06 BTM\nSOMEWHERE EARTHQUAKE, SOMEWHERE,CHN\nEPICENTER  30.0N 90.0E DEPTH 9 KM\n\
         MAGNITUDE  4.0(Ms)\nSTATION: 001ABC 30.1N 90.1E\nSITE CONDITION: SOIL\nINSTRUMENT TYPE: ETNA/ES-T\nOBSERVING POINT: GROUND\n\
         COMP. EW\nUNCORRECTED ACCELERATION          UNIT: CM/SEC/SEC\nNO. OF POINTS:  40  EQUALLY SPACED INTERVALS OF:  0.005  SEC\n\
         PEAK VALUE:     16.986   AT   0.01 SEC    DURATION:  0.2 SEC\nPRE-EVENT TIME:  20  SEC  RECORDER TIME:  2001-02-3 04:05:00.000 BTM\nCSMNC\n\n{}",
        rows(&wave(COUNT, 16.986))
    )
}

pub fn esd() -> String {
    format!(
        "file:                         000001xa.cor\nearthquake code:              9\nstation code:                 6\n\
         orientation of transducer:    NS\nsensitivity:                  20.00V/g\nfull scale amplitude:          0.50g\n\
         sampling period:               0.010000s\nnumber of samples:             40\nunits:                        m/s*s, m/s & m\n\
         comments & processing history:\n%- linear baseline of acceleration and velocity time histories corrected\n\
         -> corrected acceleration time histories\n{}-> corrected velocity time histories\n{}\
         -> corrected displacement time histories\n{1}STOP\n",
        rows(&wave(COUNT, 1.25)),
        rows(&wave(COUNT, 0.1))
    )
}

#[test]
fn csmnc_agrees_with_its_header() {
    let none = ReadOptions::default();
    let text = csmnc();
    let record = accelerations(&text, &none);
    assert_eq!((record.format, record.unit), (Format::Csmnc, Unit::CentimetrePerSecondSquared));
    assert_eq!(
        (record.time_step, record.title.as_str()),
        (0.005, "001ABC 30.1N 90.1E, EW, SOMEWHERE EARTHQUAKE, SOMEWHERE,CHN")
    );
    assert_values(&record, &wave(COUNT, 0.16986), 1e-7);
    assert_eq!(doubt(&text, &none), None);
    assert!(doubt(&text.replace("16.986   AT", "17.000   AT"), &none).unwrap().ends_with("line 13 states 17 cm/s²"));
    assert!(refusal(&text, &unit_and_step(Unit::G, 0.005)).contains("the file is in cm/s² but g was given"));
    assert!(refusal(&text.replace("  40  ", "  41  "), &none).contains("found 40 values in the file, expected 41"));
    let velocity =
        text.replace("UNCORRECTED ACCELERATION          UNIT: CM/SEC/SEC", "CORRECTED VELOCITY UNIT: CM/SEC");
    assert!(refusal(&velocity, &none).starts_with("made-up, line 11: found \"CORRECTED VELOCITY UNIT: CM/SEC\""));
}

#[test]
fn of_three_blocks_the_accelerations_are_read() {
    let none = ReadOptions::default();
    let text = esd();
    let record = accelerations(&text, &none);
    assert_eq!((record.format, record.unit), (Format::Esd, Unit::MetrePerSecondSquared));
    assert_eq!((record.time_step, record.title.as_str()), (0.01, "earthquake code: 9, station code: 6, NS"));
    assert_values(&record, &wave(COUNT, 1.25), 1e-6);
    assert!(
        refusal(&text, &unit_and_step(Unit::MetrePerSecondSquared, 0.02))
            .contains("a time step of 0.01 s but 0.02 s was given")
    );
    assert!(
        refusal(&text.replace("             40", "             41"), &none)
            .contains("found 40 values in the file, expected 41")
    );
    assert!(refusal(&text.replace("units: ", "unit:  "), &none).contains("expected a line each of"));
}
