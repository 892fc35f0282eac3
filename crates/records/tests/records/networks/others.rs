//! GeoNet, NSMN, UNAM, CWB and AFAD.

use std::fmt::Write;

use rocking_records::{Format, ReadOptions, Unit};

use super::super::{accelerations, refusal};
use super::{COUNT, assert_values, block, channel, doubt, wave};

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
fn both_geonet_volumes_are_read() {
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
        "made-up, line 20: found 20 values in the file, expected 40, the header's 4th integer"
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
fn nsmn_components_are_read() {
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
        "made-up, line 5: found 39 values in the file, expected 40, the header's NUMBER OF DATA"
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
fn unam_channels_are_read() {
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
        let message = format!(
            "made-up, line 13: found {rows} values in the file, expected 40, the header's NUM. TOTAL DE MUESTRAS"
        );
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
fn cwb_components_are_read() {
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
        "made-up, line 8: found 39 values in the file, expected 40, the header's #RecordLength(sec) times #SampleRate(Hz)"
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
