//! Made-up columns of numbers: those that are read, and those that could be something else.

use rocking_block::records::{Column, Format, ReadOptions, Unit};

use super::{accelerations, assert_refused, parsed, refusal, said};

#[test]
fn time_columns() {
    let g = ReadOptions { unit: Some(Unit::G), ..ReadOptions::default() };
    assert_eq!(
        refusal("0.00 1\n0.01 2\n0.02 3\n0.04 4\n0.05 5\n", &g),
        "made-up, line 4: found time 0.04 s, expected 0.03 s (even steps of 0.01 s)"
    );
    assert_eq!(
        refusal("0.00 1\n0.01 2\n0.01 3\n", &g),
        "made-up, line 3: found \"time 0.01 s\", expected a time after 0.01 s"
    );
    assert_refused("t [ms],a [g]\n0,0\n1,1\n", "made-up, line 1: found \"ms\", expected times in seconds, as t [s]");
    // Times printed to four decimals of a step of 1/256 s, from an offset.
    let text: String = (0..1000).map(|i| format!("{:.4} 0.1\n", 5.0 + f64::from(i) / 256.0)).collect();
    let record = accelerations(&text, &g);
    assert_eq!(record.start_time, 5.0);
    assert!((record.time_step * 256.0 - 1.0).abs() < 1e-4 / 999.0 * 256.0, "{}", record.time_step);
    assert_eq!(accelerations(&text, &said(Unit::G, 1.0 / 256.0)).time_step, 1.0 / 256.0);
    // Times printed as programs print single precision.
    let text: String = (0..20_000u16).map(|i| format!("{} 0.1\n", f32::from(i) * 0.005_f32)).collect();
    assert_eq!(accelerations(&text, &g).time_step, 0.005);
}

#[test]
fn delimited_files() {
    let none = ReadOptions::default();
    let expected = [0.5, -0.25, 0.125];
    for text in [
        "t [s],a_gx [m/s2]\n0,0.5\n0.01,-0.25\n0.02,0.125\n",
        "\u{feff}\"Time (s)\";\"Acceleration (m/s²)\"\r\n0,00;0,5\r\n0,01;-0,25\r\n0,02;0,125\r\n",
        "# from a shaking table\n# t [s], a [m/s2]\n0, 0.5,\n\n0.01, -0.25,\n0.02, 0.125,\n",
        "Accelerogram: north\n\nTime [sec]   Acceleration [m/s2]\n0.00  .5\n0.01  -2.5D-01\n0.02  .125",
        "t [s]\ta [cm/s2]\r0\t50\r0.01\t-25\r0.02\t12.5\r",
    ] {
        let record = accelerations(text, &none);
        assert_eq!((record.format, record.time_step), (Format::Columns, 0.01), "{text}");
        assert!(record.acceleration.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{record:?}");
    }
    let table = "t,a_gx [m/s2],a_gy [g]\n0,1,3\n0.5,2,4\n";
    assert_refused(
        table,
        "made-up, line 1: found 3 columns named t, a_gx [m/s2], a_gy [g], which leaves open where the accelerations are; expected acceleration column 1 to 3 or a name",
    );
    for (column, unit, first) in [("A_GX", Unit::MetrePerSecondSquared, 1.0), ("3", Unit::G, 3.0 * 9.81)] {
        let options = ReadOptions { acceleration_column: Some(column.parse().unwrap()), ..none.clone() };
        let record = accelerations(table, &options);
        assert_eq!((record.unit, record.time_step, record.acceleration[0]), (unit, 0.5, first));
    }
    let found = "made-up, line 1: found 3 columns named t, a_gx [m/s2], a_gy [g], not";
    let missing = ReadOptions { acceleration_column: Some(Column::Number(0)), ..none.clone() };
    assert_eq!(refusal(table, &missing), format!("{found} column 0; expected acceleration column 1 to 3 or a name"));
    let missing = ReadOptions { time_column: Some(Column::Name("T1".into())), ..none.clone() };
    assert_eq!(refusal(table, &missing), format!("{found} \"T1\"; expected time column 1 to 3 or a name"));
    // A table without names is not taken for a block of values in reading order.
    let bare = "0.00 1 2\n0.01 3 4\n0.02 5 6\n";
    assert_eq!(
        refusal(bare, &said(Unit::G, 0.01)),
        "made-up, line 1: found 3 columns without names, which leaves open where the accelerations are; expected acceleration column 1 to 3"
    );
    assert_eq!(
        refusal("a [g]\r\n0.1\r\n\r\n0.2\r\nx\r\n", &ReadOptions { time_step: Some(0.01), ..none.clone() }),
        "made-up, line 5: found \"x\", expected a finite number"
    );
    assert_refused("t,a [g]\r\n0,1\r\n\r\n1,2\r\n2,x\r\n", "made-up, line 5: found \"x\", expected a finite number");
    assert_refused("t,a [g]\n0,1\n1\n", "made-up, line 3: found \"1 columns\", expected 2 columns as in line 2");
}

/// Counts and time steps that stand before the values in a way that no format has.
#[test]
fn headers_of_numbers_are_not_read_as_values() {
    let cm = said(Unit::CentimetrePerSecondSquared, 0.01);
    assert_eq!(
        refusal("10 0.01 7\n1 2 3 4 5\n6 7 8 9 10\n", &cm),
        "made-up, line 2: found \"5 numbers in a line\", expected 3 as in the lines before, or an NPTS line before them"
    );
    assert!(parsed("1 2 3 4 5\n3 7 8 9 10\n2\n\n", &cm).is_ok());
    assert_eq!(
        refusal("20 0.01\n1\n2\n", &ReadOptions { time_step: None, ..cm.clone() }),
        "made-up, line 2: found \"1 columns\", expected 2 columns as in line 1"
    );
    assert_eq!(
        refusal(&format!("25\n{}", "0.5\n".repeat(25)), &cm),
        "made-up, line 1: found \"25, the count of the values after it\", expected an acceleration"
    );
    let titled = accelerations("Time history of Tabas (Iran)\n0.5\n0.25\n", &said(Unit::G, 0.02));
    assert_eq!((titled.acceleration.len(), titled.time_step), (2, 0.02));
    let message = refusal("acceleration (furlongs)\n0.5\n0.25\n", &cm);
    assert!(message.ends_with("expected a unit among g, m/s2, cm/s2"), "{message}");
}
