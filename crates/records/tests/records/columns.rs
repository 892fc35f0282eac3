//! Synthetic columns of numbers: valid tables, and ambiguous ones.

use rocking_records::{Choice, Format, ReadOptions, Unit, parse_with_doubt};

use super::{accelerations, assert_refused, parsed, refusal, unit_and_step};

#[test]
fn time_columns_must_be_evenly_spaced() {
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

/// Python, pandas and JavaScript write a time with as many digits as it needs, so that a 0.0 tells nothing of the precision.
#[test]
fn time_steps_of_times_in_shortest_form_are_exact() {
    let g = ReadOptions { unit: Some(Unit::G), ..ReadOptions::default() };
    let step = |from: f64, rows: u16, step: f64, print: &dyn Fn(f64) -> String| {
        let time = |row: u16| print(from + f64::from(row) * step);
        accelerations(&(0..rows).map(|row| format!("{} 0.1\n", time(row))).collect::<String>(), &g).time_step
    };
    for true_step in [1.0 / 128.0, 1.0 / 60.0, 1.0 / 300.0, 0.012_153_719_660_669_45, 0.01, 0.005, 0.02, 0.5] {
        for rows in [3, 100, 101, 701, 12_801] {
            for print in [&|t: f64| format!("{t:?}") as String, &|t: f64| format!("{t}")] as [&dyn Fn(f64) -> String; 2]
            {
                let found = step(0.0, rows, true_step, print);
                assert!(
                    (found - true_step).abs() <= 2.0 * f64::EPSILON * true_step,
                    "{found} for {true_step}, {rows} rows"
                );
            }
        }
    }
    // Rounded to digits, the times allow a step within half a unit of the last one over all intervals.
    for (true_step, rows) in [(1.0 / 128.0, 701), (1.0 / 60.0, 3001), (0.005, 12_801)] {
        let found = step(0.0, rows, true_step, &|t| format!("{}", format!("{t:.5e}").parse::<f64>().unwrap()));
        let end = true_step * f64::from(rows - 1);
        let unit = 10_f64.powi(end.log10().floor() as i32 - 5);
        assert!((found - true_step).abs() * f64::from(rows - 1) <= unit, "{found} for {true_step}, {rows} rows");
    }
    // Decimal steps are found in sums that drift.
    let mut sum = 0.0;
    let summed = (0..5000).map(|_| (format!("{sum:?} 0.1\n"), sum += 0.01).0).collect::<String>();
    assert_eq!(accelerations(&summed, &g).time_step, 0.01);
}

#[test]
fn delimited_files_are_read_with_any_delimiter() {
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
    let wide: Vec<String> = (0..20_001).map(|i| format!("c{i}")).collect();
    let refused = refusal(&format!("{}\n{}1\n", wide.join(","), "1,".repeat(20_000)), &none);
    assert!(
        refused.contains("found 20001 columns named c0, c1, c2, c3, c4, c5, c6, c7, c8, c9 and 19991 more, but no"),
        "{refused}"
    );
    for (column, unit, first) in [("A_GX", Unit::MetrePerSecondSquared, 1.0), ("3", Unit::G, 3.0 * 9.81)] {
        let options = ReadOptions { acceleration_column: Some(column.parse().unwrap()), ..none.clone() };
        let record = accelerations(table, &options);
        assert_eq!((record.unit, record.time_step, record.acceleration[0]), (unit, 0.5, first));
    }
    let found = "made-up, line 1: found 3 columns named t, a_gx [m/s2], a_gy [g], not";
    let missing = ReadOptions { acceleration_column: Some(Choice::Number(0)), ..none.clone() };
    assert_eq!(refusal(table, &missing), format!("{found} column 0; expected acceleration column 1 to 3 or a name"));
    let missing = ReadOptions { time_column: Some(Choice::Name("T1".into())), ..none.clone() };
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
    let warning = |text: &str| parse_with_doubt("made-up", text.as_bytes(), &options).unwrap().1;
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
    let options = ReadOptions { acceleration_column: Some(Choice::Number(2)), ..ReadOptions::default() };
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
        "made-up, line 1: found 2 values in the file, expected 20, the header's count before the time step"
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

/// A header of text without names, over values in reading order: every eighth value is no accelerogram.
#[test]
fn no_column_is_offered_for_a_block_under_text() {
    let block = "  -12085   -12085   -12070   -12060\n  -12073   -12070   -12070   -12080\n  -12079   -12091   -12079   -12066\n";
    let step =
        ReadOptions { time_step: Some(0.01), unit: Some(Unit::CentimetrePerSecondSquared), ..ReadOptions::default() };
    for options in [ReadOptions::default(), step.clone()] {
        let expected = format!(
            "made-up, line 3: found 4 numbers a line under a header of text that is of no known format ({}) and names no columns; \
             expected layout as 10F8.2, with the lines to skip before the numbers and npts, the count of them, if others follow",
            Format::NAMES
        );
        // The second line has a word for each column, but a number is no name.
        for remark in ["Remark", "peak 0.131 mm s"] {
            assert_eq!(refusal(&format!("Station AOM001\n{remark}\n{block}"), &options), expected);
        }
    }
    // The choice of a column gets the arrangement of the numbers as an answer.
    let chosen = ReadOptions { acceleration_column: Some(Choice::Number(2)), ..step.clone() };
    let doubt = |text: &str| parse_with_doubt("made-up", text.as_bytes(), &chosen).unwrap().1;
    assert_eq!(
        doubt(&format!("Station AOM001\nRemark\n{}", block.replace("-12", "-"))).unwrap(),
        "line 3 has 4 numbers without names below text, as in reading order, and column 2 of them was read; a layout reads all"
    );
    assert_eq!(doubt("Station AOM001\na b c d\n1 2 3 4\n4 3 2 1\n1 1 1 1\n"), None);
    // Times in the first column are a table.
    let table = "Station AOM001\nRemark\n0.00 1 2 3\n0.01 2 3 4\n0.02 3 4 5\n0.03 4 5 6\n";
    assert!(refusal(table, &ReadOptions::default()).contains("no clear acceleration column"));
    // The header of K-NET, also with a column chosen.
    let knet = format!("Sampling Freq(Hz) 100Hz\nScale Factor      3920(gal)/6182761\nMemo.\n{block}");
    let chosen = ReadOptions { acceleration_column: Some(Choice::Number(1)), ..step };
    for options in [ReadOptions::default(), chosen] {
        assert!(
            refusal(&knet, &options).contains("expected a line of \"Duration Time(s)\""),
            "{}",
            refusal(&knet, &options)
        );
    }
}

/// Comments on the origin of a table are not taken for a header of another format, nor for a spectrum.
#[test]
fn comments_do_not_hide_a_table() {
    let rows = "t [s],a [m/s2]\n0,1\n0.01,2\n0.02,-1\n";
    for title in ["Matched to the spectra of a code", "12 POINTS OF ACCEL DATA", "Period of the earthquake"] {
        let record =
            accelerations(&format!("# {title}\n# from NPTS.AT2: PEER AT2, in g\n{rows}"), &ReadOptions::default());
        assert_eq!((record.format, record.title.as_str(), record.time_step), (Format::Columns, title, 0.01));
    }
    let spectrum = refusal("# Response spectrum\nT [s],Sa [g]\n0.1,1\n0.2,2\n", &ReadOptions::default());
    assert!(spectrum.contains("found a response spectrum"), "{spectrum}");
    // A header of PEER in comments still is one.
    let peer = "# NPTS= 3, DT= .01 SEC\n0.1 0.2 0.3\n";
    assert_eq!(
        accelerations(peer, &ReadOptions { unit: Some(Unit::G), ..ReadOptions::default() }).format,
        Format::Peer
    );
}

/// A peak beyond that of any earthquake is reported in any format.
#[test]
fn a_peak_above_5_g_is_reported_with_names_too() {
    let warning = |peak: f64| {
        let text = format!("t [s],a [m/s2]\n0,0\n0.1,{peak}\n0.2,0\n");
        parse_with_doubt("made-up", text.as_bytes(), &ReadOptions::default()).unwrap().1
    };
    assert_eq!(warning(48.0), None);
    assert_eq!(warning(50.0).unwrap(), "the peak is 5.000e1 m/s², more than in any earthquake");
}

/// Fortran's layouts of lines: touching numbers, implied points, exponents of `D` and without a letter.
#[test]
fn fixed_widths_are_read_by_a_layout() {
    let options = |layout: &str, skip: usize| ReadOptions {
        layout: Some(layout.parse().unwrap()),
        skip: Some(skip),
        ..unit_and_step(Unit::MetrePerSecondSquared, 0.01)
    };
    let expected = [1.5, -12.25, 100.0, -3.0, 0.5];
    for (layout, lines) in [
        ("3F6.2", "  1.50-12.25100.00\n -3.00  0.50\n"),
        ("(3F6.2)", "  1.50-12.25100.00\r\n -3.00  0.50\r\n"),
        ("3 f6.2", "   150 -1225 10000\n  -300    50\n"),
        ("2x,3F6.2", "ab  1.50-12.25100.00\ncd -3.00  0.50\n"),
        ("3(F6.2)", "  1.50-12.25100.00\n -3.00  0.50"),
        ("1P3F7.2", "  15.00-122.501000.00\n -30.00   5.00\n"),
        ("3(1PE9.3E1)", " 1.500D+0-1.225E+1 1.000e+2\n-3.000E+0 5.000D-1\n"),
        ("3E9.3", "  1.500+0-1.225E+1  1.000+2\n -3.000+0  5.000-1\n"),
        ("F8.2", "    1.50\n  -12.25\n\n  100.00\n   -3.00\n    0.50\n*** End\n"),
    ] {
        let record = accelerations(&format!("A TITLE\n 1 2 3\n{lines}"), &options(layout, 2));
        assert_eq!((record.format, record.title.as_str()), (Format::Fixed, "A TITLE"), "{layout}");
        assert!(record.acceleration.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{layout}: {record:?}");
        assert_eq!(record.acceleration.len(), expected.len());
    }
    let integers = ReadOptions { value_scale: Some(0.001), ..options("5I6", 0) };
    let scaled = accelerations("  1500-12250 10000 -3000   500\n  1500\n", &integers);
    assert!(scaled.acceleration.iter().zip([1.5, -12.25, 10.0, -3.0, 0.5, 1.5]).all(|(a, b)| (a - b).abs() < 1e-12));
    // A column of several, with times.
    let pairs = "  0.00  1.50  9.00\n  0.01-12.25  9.00\n  0.02 -3.00  9.00\n";
    let table = ReadOptions {
        time_step: None,
        time_column: Some(Choice::Number(1)),
        acceleration_column: Some(Choice::Number(2)),
        ..options("3F6.2", 0)
    };
    let record = accelerations(pairs, &table);
    assert_eq!((record.time_step, record.acceleration.to_vec()), (0.01, vec![1.5, -12.25, -3.0]));
    let refused = |text: &str, layout: &str| refusal(text, &options(layout, 0));
    assert_eq!(
        refused("  1.50  2.50\n  1.50\n  1.50  2.50\n", "2F6.2"),
        "made-up, line 2: found \"1 columns of 6 characters\", expected 2, as in the layout"
    );
    assert_eq!(
        refused("  1.50  2.50  3.50\n", "2F6.2"),
        "made-up, line 1: found \"3 columns of 6 characters\", expected 2, as in the layout"
    );
    assert_eq!(refused("  1.50  a.50\n", "2F6.2"), "made-up, line 1: found \"A.50\", expected a finite number");
    let long = "    1.25".repeat(20);
    assert!(refused(&format!("{long}   -1.2"), "21F8.2").contains("the file ends within the number"));
    // Integers have no decimals that would show a cut.
    assert_eq!(
        refused("  1500-12250\n 10000 -300", "2I6"),
        "made-up, line 2: the file ends within the number \"-300\", expected columns of 6 characters as in all numbers before"
    );
    assert!(
        parsed("  1500-12250\n 10000 -3000", &ReadOptions { value_scale: Some(0.001), ..options("2I6", 0) }).is_ok()
    );
    let three = ReadOptions { acceleration_column: Some(Choice::Number(3)), ..options("2F6.2", 0) };
    assert_eq!(
        refusal("  1.50  2.50\n", &three),
        "made-up: the layout has 2 columns, not column 3; expected acceleration column 1 to 2"
    );
    let none = ReadOptions { format: Some(Format::Fixed), ..ReadOptions::default() };
    assert_eq!(refusal("1\n2\n", &none), "made-up: columns of fixed width without a layout; expected layout as 10F8.2");
    let scale = ReadOptions { value_scale: Some(0.0), ..options("2F6.2", 0) };
    assert_eq!(refusal("1\n2\n", &scale), "made-up: value scale = 0; expected a finite number above 0");
    for wrong in
        ["", "10", "F", "10F", "F8", "10F8.2X", "A8", "0F8.2", "10F0.2", "10F8.2,2F8.2", "((F8.2)", "9999F8.2", "é8.2"]
    {
        let error = wrong.parse::<rocking_records::FixedLayout>().unwrap_err().to_string();
        assert!(error.starts_with("found layout") && error.contains("as 10F8.2"), "{wrong}: {error}");
    }
}

/// Dates with times of day count from the first one, across midnight and leap days.
#[test]
fn dates_are_times() {
    let options = ReadOptions { unit: Some(Unit::G), ..ReadOptions::default() };
    for text in [
        "2024-02-28T23:59:59.99Z,0.1\n2024-02-29T00:00:00.00Z,0.2\n2024-02-29T00:00:00.01Z,0.3\n",
        "2023/12/31 23:59:59.99 0.1\n2024/01/01 00:00:00.00 0.2\n2024/01/01 00:00:00.01 0.3\n",
        "Time (JST);a\n2023-02-28 23:59:59,99;0,1\n2023-03-01 00:00:00,00;0,2\n2023-03-01 00:00:00,01;0,3\n",
        "date,a [g]\n2024-02-29T23:59:59.990+09:00,0.1\n2024-03-01T00:00:00.000+09:00,0.2\n2024-02-29T15:00:00.010+00:00,0.3\n",
        "UTC\tacc\n16:43:15.25\t0.1\n16:43:15.26\t0.2\n16:43:15.27\t0.3\n",
        "16:43:15.25 0.1\n16:43:15.26 0.2\n16:43:15.27 0.3\n",
    ] {
        let record = accelerations(text, &options);
        assert_eq!((record.start_time, record.time_step, record.acceleration.len()), (0.0, 0.01, 3), "{text}");
    }
    // Days are exact over centuries.
    let days = "1900-02-28T12:00:00.0,1\n2000-02-29T12:00:00.0,2\n2100-03-01T12:00:00.0,3\n";
    assert!((accelerations(days, &options).time_step - 36_525.0 * 86_400.0).abs() < 1.0);
    assert_eq!(
        refusal("2024-08-08T16:43:15.00 1\n2024-08-08T16:43:15.01 2\n2024-08-08T16:43:15.03 3\n", &options),
        "made-up, line 3: found time 0.03 s, expected 0.02 s (even steps of 0.01 s)"
    );
    assert_eq!(
        refusal("2024-08-08T16:43:15.00,1\n0.01,2\n", &options),
        "made-up, line 2: found \"0.01\", expected a date and a time as 2024-08-08T16:43:15.25"
    );
    for wrong in [
        "2024-13-08T16:43:15",
        "2024-08-08T24:43:15",
        "2024-08-08T16:60:15",
        "2024-08-08",
        "16:43",
        "2024-08-08T16:43:15.x",
    ] {
        assert!(parsed(&format!("{wrong},1\n{wrong},2\n"), &options).is_err(), "{wrong}");
    }
}
