//! K-NET, KiK-net and the seismic intensity meters of JMA.

use std::fmt::Write;

use rocking_records::{Format, ReadOptions, Unit};

use super::super::{accelerations, refusal};
use super::{COUNT, assert_values, block, channel, doubt, wave};

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
        "made-up, line 12: found 32 values in the file, expected 40, the header's Duration Time(s) times Sampling Freq(Hz)"
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
        "made-up, line 12: found 39 values in the file, expected 40, the header's #DurationTime(s) times #SamplingFrequency(Hz)"
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
fn jma_components_are_read() {
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
    // Files of other years: eight columns in all lines, a blank before the sign, and another word for the rate.
    let expected = accelerations(&text, &channel("EW")).acceleration;
    let (header, rows) = text.split_once("NS,EW,UD\n").unwrap();
    let wide = format!("{header}NS,EW,UD\n{rows}").replace('\n', ",,,,,\n");
    let blank = text.replace('=', " =").replace("2001 02", "01 02");
    let rate = text.replace("SAMPLING RATE= 100Hz", "Sampling Freq= 100Hz,,").replace("07 58 13", "07 58 13,,");
    for text in [wide, blank, rate] {
        let record = accelerations(&text, &channel("EW"));
        assert_eq!(
            (record.format, record.time_step, &record.acceleration),
            (Format::Jma, 0.01, &expected),
            "{}",
            &text[..300]
        );
        assert!(
            record.title.starts_with("47675大島町, ") && record.title.ends_with("01 02 03 07 58 13, EW"),
            "{}",
            record.title
        );
    }
    assert!(refusal(&text.replace(",  ", ",, "), &channel("NS")).contains("expected"));
    // Shift-JIS, as the agency writes it.
    let (before, after) = text.split_once("大島町").unwrap();
    let bytes = [before.as_bytes(), b"\x91\xE5\x93\x87\x92\xAC", after.as_bytes()].concat();
    assert_eq!(
        rocking_records::parse("jma", &bytes, &channel("NS")).unwrap().acceleration,
        accelerations(&text, &channel("NS")).acceleration
    );
}
