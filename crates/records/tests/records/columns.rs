//! Synthetic columns of numbers: valid tables, and ambiguous ones.

use rocking_records::{Column, Format, ReadOptions, Unit, implausibility};

use super::{accelerations, assert_refused, parsed, refusal, unit_and_step};

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
    assert_eq!(accelerations(&text, &unit_and_step(Unit::G, 1.0 / 256.0)).time_step, 1.0 / 256.0);
    // Times printed from single precision.
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
        "made-up, line 1: found 3 columns named t, a_gx [m/s2], a_gy [g], but no clear acceleration column; expected acceleration column 1 to 3 or a name",
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
    // A table without names is not read as a block of values in reading order.
    let bare = "0.00 1 2\n0.01 3 4\n0.02 5 6\n";
    assert_eq!(
        refusal(bare, &unit_and_step(Unit::G, 0.01)),
        "made-up, line 1: found 3 columns without names, but no clear acceleration column; expected acceleration column 1 to 3"
    );
    assert_eq!(
        refusal("a [g]\r\n0.1\r\n\r\n0.2\r\nx\r\n", &ReadOptions { time_step: Some(0.01), ..none.clone() }),
        "made-up, line 5: found \"x\", expected a finite number"
    );
    assert_refused("t,a [g]\r\n0,1\r\n\r\n1,2\r\n2,x\r\n", "made-up, line 5: found \"x\", expected a finite number");
    assert_refused("t,a [g]\n0,1\n1\n", "made-up, line 3: found \"1 columns\", expected 2 columns as in line 2");
}

/// A separate line of units is not a header row.
#[test]
fn a_line_of_units_is_no_header_row() {
    let none = ReadOptions::default();
    for text in [
        "# unit: m/s2\n0 0.5\n0.01 -0.25\n0.02 0.125\n",
        "# Units = m/s^2\n0,0.5\n0.01,-0.25\n0.02,0.125\n",
        "# unit m/s2\n0 0.5\n0.01 -0.25\n0.02 0.125\n",
        "# s m/s2\n0 0.5\n0.01 -0.25\n0.02 0.125\n",
        "t,a\n[s],[m/s2]\n0,0.5\n0.01,-0.25\n0.02,0.125\n",
        "# t a\n# unit: m/s2\n0 0.5\n0.01 -0.25\n0.02 0.125\n",
        "s;cm/s2\n0;50\n0,01;-25\n0,02;12,5\n",
    ] {
        let record = accelerations(text, &none);
        assert_eq!((record.format, record.time_step), (Format::Columns, 0.01), "{text}");
        assert!(record.acceleration.iter().zip([0.5, -0.25, 0.125]).all(|(a, b)| (a - b).abs() < 1e-15), "{record:?}");
    }
    let alone = accelerations("# g\n0.5\n0.25\n", &ReadOptions { time_step: Some(0.01), ..none.clone() });
    assert_eq!(alone.unit, Unit::G);
    let velocity = "made-up, line 1: found a velocity";
    for text in ["# unit: cm/s\n0 0.5\n0.01 -0.25\n", "# s cm/s\n0 0.5\n0.01 -0.25\n"] {
        assert!(refusal(text, &none).starts_with(velocity), "{}", refusal(text, &none));
    }
}

/// The numbers of a table without names can show that they are not accelerations.
#[test]
fn implausible_numbers_without_names_are_reported() {
    let waves = |hertz: f64, peak: f64| -> String {
        let value = |i: u32| peak * (std::f64::consts::TAU * hertz * 0.01 * f64::from(i)).sin();
        (0..1000).map(|i| format!("{:.2} {:.6}\n", 0.01 * f64::from(i), value(i))).collect()
    };
    let options = ReadOptions { unit: Some(Unit::MetrePerSecondSquared), ..ReadOptions::default() };
    let warning = |text: &str| implausibility(text.as_bytes(), &accelerations(text, &options));
    assert_eq!(warning(&waves(3.0, 4.0)), None);
    assert!(warning(&waves(0.5, 0.8)).unwrap().contains("the mean frequency is 0.50 Hz, as low as that of velocities"));
    assert!(warning(&waves(3.0, 166.0)).unwrap().contains("more than in any earthquake"));
    // A name settles the question.
    assert_eq!(warning(&format!("t [s] a [m/s2]\n{}", waves(0.5, 0.8))), None);
}

/// Tables without quotes, split directly, equal quoted ones read by the CSV parser.
#[test]
fn quoted_tables_are_read_as_bare_ones() {
    let lines = ["t,a [m/s2],note", "0,0.5,x", "# between,,", ",,", "0.01, -0.25 ,", "", "0.02,1.25D-1,,"];
    let bare = lines.join("\n") + "\n";
    let quoted = bare.replace(",x", ",\"x\"");
    let options = ReadOptions { acceleration_column: Some(Column::Number(2)), ..ReadOptions::default() };
    let read = |text: &str| parsed(text, &options).map_err(|error| error.to_string());
    assert_eq!(read(&bare), read(&quoted));
    let uneven = |text: &str| text.replace("0.02,", "0.03,");
    assert_eq!(read(&uneven(&bare)), read(&uneven(&quoted)));
}

/// Counts and time steps before the values, arranged as in no known format.
#[test]
fn headers_of_numbers_are_not_read_as_values() {
    let cm = unit_and_step(Unit::CentimetrePerSecondSquared, 0.01);
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
    let titled = accelerations("Time history of Tabas (Iran)\n0.5\n0.25\n", &unit_and_step(Unit::G, 0.02));
    assert_eq!((titled.acceleration.len(), titled.time_step), (2, 0.02));
    let message = refusal("acceleration (furlongs)\n0.5\n0.25\n", &cm);
    assert!(message.ends_with("expected a unit among g, m/s2, cm/s2"), "{message}");
}
