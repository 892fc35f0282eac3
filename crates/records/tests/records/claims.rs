//! Headers that state quantity, unit and time step in words of many kinds: read without options, or refused with a sentence that names
//! line, content and option.

use rocking_records::{Choice, Format, ReadOptions, Unit};

use super::{accelerations, refusal, unit_and_step};

const COLUMN: &str = "0.1\n0.2\n-0.3\n0.1\n";
const TABLE: &str = "0.00 0.1\n0.01 0.2\n0.02 -0.3\n0.03 0.1\n";
const TABBED: &str = "0.00\t0.1\t1.1\n0.01\t0.2\t1.2\n0.02\t-0.3\t1.3\n";

fn unit(unit: Unit) -> ReadOptions {
    ReadOptions { unit: Some(unit), ..ReadOptions::default() }
}

fn column(number: usize, unit: Unit) -> ReadOptions {
    ReadOptions { unit: Some(unit), acceleration_column: Some(Choice::Number(number)), ..ReadOptions::default() }
}

/// A header that names unit and step in words needs no option, and no option contradicts it.
#[test]
fn words_of_a_header_are_its_unit_and_step() {
    use Unit::{CentimetrePerSecondSquared as Cm, G, MetrePerSecondSquared as M};
    for (text, expected_unit, step) in [
        ("# Tasa de muestreo: 200 muestras/seg\n# Unidades: m/seg/seg\n0.1\n0.2\n", M, 0.005),
        ("# Frecuencia de muestreo = 100 Hz\n# Aceleración en cm/s2\n0.1\n0.2\n", Cm, 0.01),
        ("Abtastrate 200 Hz\nBeschleunigung in m/s²\n0.1\n0.2\n", M, 0.005),
        ("# Time Step: 0.005\n# Accelerations in g\n0.1\n0.2\n", G, 0.005),
        ("# Accelerations in g\n# Time Step: 0.005\n0.1\n0.2\n", G, 0.005),
        ("# dt = 0.01\nFile Type: Accelerations (g)\nend of header\n0.1\n0.2\n", G, 0.01),
        ("# dt = 10 ms\n# Acceleration: g\n0.1\n0.2\n", G, 0.01),
        ("# sampling rate (Hz): 128\n# acceleration, gal\n0.1\n0.2\n", Cm, 1.0 / 128.0),
        ("# sampling rate: .005 sec, units: cm/sec^2\n0.1\n0.2\n", Cm, 0.005),
        ("STATION, 2 samples, 100 sps, 2010-02-27T06:45:00.00, SLIST, FLOAT, M/S**2\n0.1\n0.2\n", M, 0.01),
        ("PGA (g): 0.3, PGV 12.1 cm/s, full scale 0.5g\nunits: m/s^2\ndt=1/50 s\n0.1\n0.2\n", M, 0.02),
        ("Accelerations (g)\nNPTS = 2 , DT = 0.01 SEC\n0.1\n0.2\n", G, 0.01),
    ] {
        let record = accelerations(text, &ReadOptions::default());
        assert_eq!((record.unit, record.time_step), (expected_unit, step), "{text}");
        let other = if expected_unit == G { M } else { G };
        let message = refusal(text, &unit(other));
        assert!(message.contains(&format!("the file is in {expected_unit} but {other} was given")), "{message}");
        let message = refusal(text, &ReadOptions { time_step: Some(0.04), ..ReadOptions::default() });
        assert!(message.contains(&format!("a time step of {step} s but 0.04 s was given")), "{message}");
        // The options that agree change nothing.
        assert_eq!(accelerations(text, &unit_and_step(expected_unit, step)), record, "{text}");
    }
}

/// Velocities, displacements and readings of instruments are refused whatever the option says.
#[test]
fn another_quantity_anywhere_in_a_header_is_refused() {
    let m = Unit::MetrePerSecondSquared;
    for (text, options, line, found) in [
        (
            "Velocities (cm/s)\n# made up\n0.1\n0.2\n".to_owned(),
            unit_and_step(m, 0.01),
            1,
            "a velocity (\"Velocities (cm/s)\")",
        ),
        (format!("File Type: Velocity\nmade up here\n{TABLE}"), unit(m), 1, "a velocity"),
        (format!("# units: cm/s\n# t a\n{TABLE}"), unit(m), 1, "a velocity"),
        (format!("Geschwindigkeit in cm/s\n\n{TABLE}"), unit(m), 1, "a velocity"),
        (format!("# Velocidad en cm/s\n#\n{TABLE}"), unit(m), 1, "a velocity"),
        (format!("Displacements (cm)\n\n{TABLE}"), unit(m), 1, "a displacement"),
        (format!("TIMESERIES A, 4 samples, 100 sps, TSPAIR, FLOAT, M/S\n{TABLE}"), unit(m), 1, "a velocity"),
        (
            format!("TIMESERIES A, 4 samples, 100 sps, TSPAIR, INTEGER, COUNTS\n{TABLE}"),
            unit(m),
            1,
            "instrument readings",
        ),
        (
            format!("# scale_units: m/s**2\n# field_unit: UTC, M/S\nTime, Sample\n{}", TABLE.replace(' ', ",")),
            unit(m),
            2,
            "a velocity",
        ),
        (format!("# LP, stat=s02\n#  time(sec)   N-S(cm/s)   E-W(cm/s)\n{TABBED}"), column(2, m), 2, "a velocity"),
        (format!("#  units= cm/s\n#\n{TABBED}"), column(2, m), 1, "a velocity"),
        (format!("Time [s] Kanal 1 [mg]\n{TABLE}"), unit(Unit::G), 1, "accelerations in a unit other than"),
    ] {
        let message = refusal(&text, &options);
        assert!(message.starts_with(&format!("made-up, line {line}: found {found}")), "{text}: {message}");
        let given = options.unit.unwrap();
        assert!(
            message.ends_with(&format!(" but {given} was given, expected an acceleration time history")),
            "{message}"
        );
        let without = refusal(&text, &ReadOptions { unit: None, ..options });
        assert!(without.starts_with(&format!("made-up, line {line}: found {found}")), "{text}: {without}");
    }
    // The caller's value of a printed 1 converts readings.
    let counts = format!("TIMESERIES A, 4 samples, 100 sps, TSPAIR, INTEGER, COUNTS\n{TABLE}");
    let scaled = ReadOptions { value_scale: Some(0.5), ..unit(m) };
    assert_eq!(accelerations(&counts, &scaled).acceleration[0], 0.05);
}

/// Values with units, remarks and the other columns of a table claim nothing.
#[test]
fn other_words_of_a_header_are_left_alone() {
    let m = unit_and_step(Unit::MetrePerSecondSquared, 0.01);
    for text in [
        format!("Vs30 = 760 m/s, PGV: 12 cm/s, PGD (cm): 3\nfilter 0.1 Hz, 25 Hz\n{COLUMN}"),
        format!("linear baseline of acceleration and velocity time histories corrected\n{COLUMN}"),
        format!("sensitivity: 20.00V/g\nshear-wave velocity 300 m/s\n{COLUMN}"),
        format!("PEAK VELOCITY = 12.1 CM/SEC, DEPTH 9 KM\nrecorded in Gilroy in 1989\n{COLUMN}"),
        format!("natural frequency: 10.0Hz\nfull scale amplitude: 0.50g\nELEVATION_M: 1820.0\n{COLUMN}"),
        "t [s],a [m/s2],v [m/s]\n0.00,0.1,5\n0.01,0.2,6\n0.02,-0.3,7\n".to_owned(),
    ] {
        assert_eq!(accelerations(&text, &m).acceleration[1], 0.2, "{text}");
    }
    // The heading of the column precedes the text.
    let heading = "# converted from cm/s2 and from a velocity time history\nt [s],a [m/s2]\n0.00,0.1\n0.01,0.2\n";
    assert_eq!(accelerations(heading, &ReadOptions::default()).unit, Unit::MetrePerSecondSquared);
    // A header with two units needs an option, and it is one of them.
    let two = format!("# raw: gal\n# converted to m/s2\n{TABLE}");
    assert_eq!(
        refusal(&two, &ReadOptions::default()),
        "made-up, line 1: the header states cm/s², and m/s² in line 2; expected unit to choose one"
    );
    assert_eq!(accelerations(&two, &unit(Unit::MetrePerSecondSquared)).acceleration[0], 0.1);
    assert!(refusal(&two, &unit(Unit::G)).contains("the file is in cm/s² but g was given"));
}

/// A column with the unit s is time in any language, so that a given step must agree with it.
#[test]
fn a_column_in_seconds_is_time() {
    for name in ["Zeit [s]", "Temps (s)", "Tempo [s]", "Tiempo (seg)", "t' [sec]", "Zeit"] {
        let text = format!("{name};a [m/s²]\n0,00;0,1\n0,01;0,2\n0,02;-0,3\n");
        assert_eq!(accelerations(&text, &ReadOptions::default()).time_step, 0.01, "{name}");
        let message = refusal(&text, &ReadOptions { time_step: Some(0.02), ..ReadOptions::default() });
        assert!(message.contains("has a time step of 0.01 s but 0.02 s was given"), "{name}: {message}");
    }
    let milli = "Zeit [ms];a [m/s²]\n0;0,1\n10;0,2\n20;-0,3\n";
    assert!(refusal(milli, &unit_and_step(Unit::MetrePerSecondSquared, 0.02)).contains("expected times in seconds"));
}

/// Count and time step in a line of their own, as programs write them.
#[test]
fn a_line_of_count_and_step_is_a_header() {
    let g = unit(Unit::G);
    let rows: String =
        (1..=30).map(|i| format!(" {} {:.4}\n", f64::from(i) * 0.005, 0.01 * f64::from(i % 7))).collect();
    let values: String = (1..=30).map(|i| format!("{:.4}\n", 0.01 * f64::from(i % 7))).collect();
    let words: Vec<&str> = values.split_whitespace().collect();
    let six: String = words.chunks(6).map(|row| row.join(" ") + "\n").collect();
    for text in [
        format!(" 30  0.005\n{rows}"),
        format!("A title\n30 0.005\n{values}"),
        format!("A title\nNPTS DT\n30 0.005\n{values}"),
        format!("A title\nanother\n30, 0.005\n{six}"),
        format!("STAT 000 title\n30 5.00000e-03 0 0 0.00 0.0 0.0 0.0\n{six}"),
    ] {
        let record = accelerations(&text, &g);
        assert_eq!((record.format, record.time_step, record.acceleration.len()), (Format::Npts, 0.005, 30), "{text}");
        assert!((record.acceleration[1] - 0.02 * 9.81).abs() < 1e-12);
        assert!(refusal(&text, &ReadOptions::default()).contains("no unit in the file"));
        assert!(refusal(&text, &unit_and_step(Unit::G, 0.01)).contains("has a time step of 0.005 s but 0.01 s"));
        assert!(
            refusal(&text.replace("30 ", "31 ").replace("30,", "31,"), &g)
                .contains("found 30 values in the file, expected 31")
        );
    }
    let velocity = format!("velocity in cm/s\n30 0.005\n{values}");
    assert!(refusal(&velocity, &g).starts_with("made-up, line 1: found a velocity"));
    let uneven = format!("30 0.005\n{}", rows.replace(" 0.15 ", " 0.16 "));
    assert!(refusal(&uneven, &g).contains("expected 0.15 s"), "{}", refusal(&uneven, &g));
}

/// A layout with an end reads the first of several blocks.
#[test]
fn a_layout_ends_after_its_values() {
    let blocks = "title\n  1.00  2.00\n  3.00  4.00\n-> velocity\n  9.00  9.00\n";
    let options = |npts: Option<usize>| ReadOptions {
        layout: Some("2F6.2".parse().unwrap()),
        skip: Some(1),
        npts,
        ..unit_and_step(Unit::MetrePerSecondSquared, 0.01)
    };
    assert_eq!(*accelerations(blocks, &options(Some(4))).acceleration, [1.0, 2.0, 3.0, 4.0]);
    assert!(refusal(blocks, &options(None)).contains("line 4: found"));
    assert_eq!(
        refusal(blocks, &options(Some(3))),
        "made-up, line 3: found 4 values up to the end of a line in the layout, not 3; expected npts 4"
    );
    let short = "title\n  1.00  2.00\n  3.00  4.00\n";
    assert!(refusal(short, &options(Some(6))).contains("found 4 values"));
    // A block that is refused without options names the layout.
    let message = refusal("Station\nRemark\n1 2 3 4\n4 3 2 1\n2 2 1 1\n", &ReadOptions::default());
    assert!(
        message.contains("expected layout as 10F8.2, with the lines to skip") && message.contains("npts"),
        "{message}"
    );
}
