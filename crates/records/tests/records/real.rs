//! Real files. Expected counts, time steps and peaks come from independent programs or from the headers.

use std::path::{Path, PathBuf};

use rocking_records::{
    Choice, Format, Peak, ReadOptions, Record, RecordError, Setting, Unit, parse_with_doubt, read, read_with_doubt,
};

use super::skipped::skip;
use super::unit_and_step;

const GRAVITY: f64 = 9.81;

/// Peaks of the table are printed to 1e-4 g.
const PEAK_TOLERANCE: f64 = 0.5001e-4;

/// Returns the folder of records that may not be redistributed, if it is available.
fn shared() -> Option<PathBuf> {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/records"));
    if folder.is_dir() {
        return Some(folder);
    }
    skip("a test of real files: the records of ../shared/records may not be redistributed and are not at hand");
    None
}

fn public(name: &str) -> Record {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/records")).join(name);
    read(&path, &ReadOptions::default()).unwrap()
}

fn without_options(folder: &Path, name: &str) -> Record {
    read(&folder.join(name), &ReadOptions::default()).unwrap()
}

fn assert_peak(record: &Record, acceleration: f64, time: f64, tolerance: f64) {
    let peak = record.peak();
    assert!((peak.acceleration - acceleration).abs() <= tolerance, "{peak:?}, expected {acceleration} m/s²");
    assert!((peak.time - time).abs() <= 1e-9, "{peak:?}, expected {time} s");
}

/// SMC headers print the largest and smallest values to seven digits, with their times.
#[test]
fn smc_agrees_with_its_header() {
    let shafter = public("0111a.smc");
    assert_eq!((shafter.format, shafter.unit), (Format::Smc, Unit::CentimetrePerSecondSquared));
    assert_eq!((shafter.acceleration.len(), shafter.time_step), (6001, 0.005));
    assert!(shafter.title.contains("Loma Prieta") && shafter.title.contains("1295 Shafter"), "{}", shafter.title);
    // "pk = 104.4"; values are printed with five digits.
    assert_peak(&shafter, 1.044078, 10.17, 5e-5);
    let smallest = shafter.acceleration.iter().copied().fold(f64::INFINITY, f64::min);
    assert!((smallest + 0.7882104).abs() <= 5e-6, "{smallest}");
    assert!((shafter.at(10.34) - smallest).abs() <= 1e-12);

    let apeel = public("np01002p_4225a_a.smc");
    assert_eq!((apeel.acceleration.len(), apeel.time_step), (7183, 0.005));
    // "pk = -222.5"
    assert_peak(&apeel, -2.225194, 7.55, 5e-5);
    assert!((apeel.at(7.095) - 1.860087).abs() <= 5e-5);
}

#[test]
fn peer_headers_of_all_kinds() {
    let Some(folder) = shared() else { return };
    let table = [
        ("paper/NGA_no_1063_RRS228.AT2", 0.01, 1991, 0.8252),
        ("paper_derived/ERZ-EW_unrotated.AT2", 0.005, 4156, 0.4955),
        ("paper_derived/ERZ-FN032.AT2", 0.005, 4156, 0.4864),
        ("paper_derived/ERZ-NS_unrotated.AT2", 0.005, 4156, 0.5153),
        ("paper_derived/RRS-FN032.AT2", 0.01, 1991, 0.8698),
        ("paper_derived/RRS228_unrotated.AT2", 0.01, 1991, 0.8252),
        ("paper_derived/RRS318_unrotated.AT2", 0.01, 1991, 0.4865),
        ("fallback/IELC180.AT2", 0.01, 4000, 0.3129),
        ("fallback/elCentro.AT2", 0.02, 1559, 0.3188),
        ("formats/elCentro_6line_header.at2", 0.02, 1559, 0.3188),
        ("formats/ARL360_crcrlf.at2", 0.02, 2000, 0.3081),
        ("formats/ARL360_pacific.at2", 0.02, 2000, 0.3081),
        ("formats/ALH360.AT2", 0.02, 3000, 0.0798),
        ("formats/Oak_2_50_5_FN.AT2", 0.005, 7997, 0.9099),
        ("formats/A-PAS180.AT2", 0.005, 12053, 0.0067),
        ("formats/ANLA196.AT2", 0.02, 1451, 0.0398),
        ("formats/EIL-EW.AT2", 0.005, 12000, 0.0967),
        ("formats/PBFEAS.AT2", 0.01, 2364, 0.0516),
        ("formats/RSN763_LOMAP_GIL067.AT2", 0.005, 7999, 0.3585),
        ("formats/RSN763_LOMAP_GIL337.AT2", 0.005, 7999, 0.3266),
        ("formats/RSN10590_ComalTX_BHZ.AT2", 0.05, 15306, 0.0000),
        ("formats/RSN1044_DirRot2.AT2", 0.02, 2000, 0.6972),
        ("formats/CHICHI04-CHY039-E.at2", 0.005, 14800, 0.0530),
        ("formats/LOMAP-A02043.at2", 0.005, 7165, 0.2735),
        ("formats/YOUNTVL-0436a360.AT2", 0.005, 9600, 0.0092),
        ("formats/RSN1_HELENA.A_A-HMC180.AT2", 0.01, 5093, 0.1608),
        ("formats/RSN1_HELENA.A_A-HMC270.AT2", 0.01, 5103, 0.1560),
    ];
    for (name, time_step, count, peak) in table {
        let record = without_options(&folder, name);
        assert_eq!((record.format, record.unit), (Format::Peer, Unit::G), "{name}");
        assert_eq!((record.time_step, record.acceleration.len()), (time_step, count), "{name}");
        let found = record.peak().acceleration.abs() / GRAVITY;
        assert!((found - peak).abs() <= PEAK_TOLERANCE, "{name}: {found} g, expected {peak} g");
    }
    assert_eq!(
        without_options(&folder, "fallback/IELC180.AT2").title,
        "IMPERIAL VALLEY 5/19/40 0439, EL CENTRO ARRAY #9, 180 (USGS STATION 117)"
    );
    assert!(without_options(&folder, "fallback/elCentro.AT2").title.starts_with("Data for El Centro 1940"));
}

#[test]
fn peer_without_header_needs_unit_and_time_step() {
    let Some(folder) = shared() else { return };
    for (name, peak) in [("SCS052", 0.6125), ("SCS142", 0.8972), ("SCSUP", 0.5862)] {
        let path = folder.join("paper").join(name).with_extension("AT2");
        let record = read(&path, &unit_and_step(Unit::G, 0.005)).unwrap();
        assert_eq!((record.format, record.acceleration.len()), (Format::Peer, 8000), "{name}");
        let found = record.peak().acceleration.abs() / GRAVITY;
        assert!((found - peak).abs() <= PEAK_TOLERANCE, "{name}: {found} g, expected {peak} g");
        let error = read(&path, &ReadOptions { unit: Some(Unit::G), ..ReadOptions::default() }).unwrap_err();
        assert!(matches!(error, RecordError::NeedsSetting { setting: Setting::TimeStep, .. }), "{error}");
        let error = read(&path, &ReadOptions { time_step: Some(0.005), ..ReadOptions::default() }).unwrap_err();
        assert!(matches!(error, RecordError::NeedsSetting { setting: Setting::Unit, .. }), "{error}");
    }
}

/// The published file and a rotation of its published components differ by the last digits, at most 1.8e-7 g.
#[test]
fn rinaldi_equals_its_rotated_components() {
    let Some(folder) = shared() else { return };
    let original = without_options(&folder, "paper/NGA_no_1063_RRS228.AT2");
    let derived = without_options(&folder, "paper_derived/RRS228_unrotated.AT2");
    assert_eq!(original.acceleration.len(), derived.acceleration.len());
    for (a, b) in original.acceleration.iter().zip(derived.acceleration.iter()) {
        assert!((a - b).abs() <= 1.8e-7 * GRAVITY * (1.0 + 1e-6), "{a} and {b} m/s²");
    }
}

#[test]
fn line_ends_make_no_difference() {
    let Some(folder) = shared() else { return };
    let plain = without_options(&folder, "formats/ARL360_pacific.at2");
    assert_eq!(without_options(&folder, "formats/ARL360_crcrlf.at2"), plain);
    let long = without_options(&folder, "formats/elCentro_6line_header.at2");
    assert_eq!(long.acceleration, without_options(&folder, "fallback/elCentro.AT2").acceleration);
}

#[test]
fn columns_with_and_without_time() {
    let Some(folder) = shared() else { return };
    // Count and last time are from the files; the unit is that of the caller.
    for (name, count, last) in [
        ("formats/CHV1-20140203E.txt", 13549, 67.74),
        ("formats/Northridge_Sylmar_County.dat", 3000, 59.98),
        ("formats/San Fernando.dat", 1500, 29.98),
        ("formats/RSN1063_NORTHR_RRS228_velocity_cm_s.txt", 1991, 19.9),
    ] {
        let options = ReadOptions { unit: Some(Unit::CentimetrePerSecondSquared), ..ReadOptions::default() };
        let record = read(&folder.join(name), &options).unwrap();
        assert_eq!((record.format, record.acceleration.len()), (Format::Columns, count), "{name}");
        assert!((record.start_time + record.duration() - last).abs() <= 1e-9, "{name}: {record:?}");
        let error = read(&folder.join(name), &ReadOptions::default()).unwrap_err();
        assert!(matches!(error, RecordError::NeedsSetting { setting: Setting::Unit, .. }), "{error}");
        let error = read(&folder.join(name), &unit_and_step(Unit::G, 0.004)).unwrap_err();
        assert!(matches!(error, RecordError::NeedsSetting { setting: Setting::TimeStep, .. }), "{error}");
    }
    for (name, count) in
        [("fallback/tabasFN.txt", 2500), ("fallback/tabasFP.txt", 2500), ("formats/rrsmv1_1.txt", 2989)]
    {
        let record = read(&folder.join(name), &unit_and_step(Unit::MetrePerSecondSquared, 0.02)).unwrap();
        assert_eq!((record.format, record.acceleration.len()), (Format::Columns, count), "{name}");
        let error = read(&folder.join(name), &ReadOptions::default()).unwrap_err();
        assert!(matches!(error, RecordError::NeedsSetting { setting: Setting::TimeStep, .. }), "{error}");
    }
}

/// Velocities without a header look like accelerations, but their peak is absurd in g.
#[test]
fn velocities_read_in_g_are_refused() {
    let Some(folder) = shared() else { return };
    let options = ReadOptions { unit: Some(Unit::G), ..ReadOptions::default() };
    let error = read(&folder.join("formats/RSN1063_NORTHR_RRS228_velocity_cm_s.txt"), &options).unwrap_err();
    assert!(matches!(error, RecordError::NeedsSetting { setting: Setting::Unit, .. }), "{error}");
    // The file's peak is 147.9.
    assert!(error.to_string().contains("the peak would be 1.479e2 g at"), "{error}");
}

#[test]
fn a_response_spectrum_is_refused() {
    let Some(folder) = shared() else { return };
    let error =
        read(&folder.join("formats/SeismoSignal_Imperial Valley.txt"), &unit_and_step(Unit::G, 0.01)).unwrap_err();
    let message = error.to_string();
    assert!(message.contains(", line 2: ") && message.ends_with("expected an acceleration time history"), "{message}");
}

/// The headers print the largest acceleration and its time.
#[test]
fn cosmos_agrees_with_its_header() {
    let Some(folder) = shared() else { return };
    let alaska = without_options(&folder, "formats/akbmrp_BNZ.acc.V2c");
    assert_eq!((alaska.format, alaska.unit), (Format::Cosmos, Unit::CentimetrePerSecondSquared));
    assert_eq!((alaska.time_step, alaska.acceleration.len()), (0.005, 42000));
    assert_peak(&alaska, -0.06851512, 76.215, 0.5e-8);

    let yucaipa = without_options(&folder, "formats/Cosmos12TimeSeriesTest.v1");
    assert_eq!((yucaipa.time_step, yucaipa.acceleration.len()), (0.01, 7000));
    // Some columns touch, so that only their width separates them.
    assert_peak(&yucaipa, -1.61962, 27.85, 0.5e-5);
}

/// The header of each channel prints the largest acceleration and its time.
#[test]
fn csmip_agrees_with_its_headers() {
    let Some(folder) = shared() else { return };
    let path = folder.join("formats/ce36456p_CE36456.V2");
    let channel = |number: Option<usize>| ReadOptions { channel: number.map(Choice::Number), ..ReadOptions::default() };
    for (number, count, peak, time) in [(1, 3251, -2.67957, 10.94), (2, 3250, -0.94805, 11.68)] {
        let record = read(&path, &channel(Some(number))).unwrap();
        assert_eq!((record.format, record.time_step, record.acceleration.len()), (Format::Csmip, 0.02, count));
        assert_peak(&record, peak, time, 1e-12);
        assert!(record.title.contains(&format!("CHAN {number}")), "{}", record.title);
    }
    for wrong in [None, Some(0), Some(4)] {
        let error = read(&path, &channel(wrong)).unwrap_err();
        assert!(matches!(error, RecordError::NeedsSetting { setting: Setting::Channel, .. }), "{error}");
        assert!(error.to_string().ends_with("; expected channel 1 to 3 or a name"), "{error}");
    }
}

/// The header prints PGA_CM/S^2 and TIME_PGA_S.
#[test]
fn esm_agrees_with_its_header() {
    let Some(folder) = shared() else { return };
    let argos = without_options(&folder, "formats/HI.ARS1.HNE.ACC.ASC");
    assert_eq!((argos.format, argos.unit), (Format::Esm, Unit::CentimetrePerSecondSquared));
    assert_eq!((argos.time_step, argos.acceleration.len()), (0.005, 19128));
    let Peak { acceleration, time } = argos.peak();
    assert!(
        (acceleration.abs() - 0.300022e-2).abs() <= 0.5e-8 && (time - 20.67).abs() <= 1e-9,
        "{acceleration} at {time}"
    );
}

/// Reads a file of the folder with a stated count replaced by that of the file's first part; returns the record and the doubt.
fn with_count(folder: &Path, name: &str, counts: [&str; 2], channel: &str) -> (Record, String) {
    let path = folder.join("formats").join(name);
    let text = std::fs::read_to_string(path).unwrap();
    let options = ReadOptions { channel: Some(channel.parse::<Choice>().unwrap()), ..ReadOptions::default() };
    let error = parse_with_doubt(name, text.as_bytes(), &options).unwrap_err();
    assert!(error.to_string().contains(" values in the file, expected "), "{error}");
    let shortened = text.replacen(counts[0], counts[1], 1);
    assert_ne!(shortened, text);
    let (record, doubt) = parse_with_doubt(name, shortened.as_bytes(), &options).unwrap();
    (record, doubt.unwrap_or_default())
}

/// Beginnings of files of national networks: refused for their count, with it they agree with the file, and their peak raises a doubt.
#[test]
fn beginnings_of_files_are_not_read_in_silence() {
    let Some(folder) = shared() else { return };
    let beginning = |record: &Record, values: &[f64]| {
        for (found, expected) in record.acceleration.iter().zip(values) {
            assert!((found - expected).abs() <= 1e-12, "{found}, expected {expected} m/s²");
        }
    };
    let (knet, doubt) = with_count(
        &folder,
        "knet_AOM0011801241951_head.EW",
        ["Duration Time(s)  102", "Duration Time(s)  14.64"],
        "E-W",
    );
    assert_eq!((knet.format, knet.acceleration.len(), knet.time_step), (Format::Knet, 1464, 0.01));
    // Differences do not depend on the mean.
    let difference = knet.acceleration[3] - knet.acceleration[0];
    assert!((difference - 25.0 * 3920.0 / 6_182_761.0 / 100.0).abs() <= 1e-12, "{difference}");
    assert!(doubt.ends_with("line 15 states 4.078 cm/s²"), "{doubt}");

    let durations = ["#DurationTime(s)\n#71", "#DurationTime(s)\n#0.16"];
    let (csv, doubt) = with_count(&folder, "knet_csv_head.csv", durations, "U-D");
    beginning(&csv, &[0.0047, 0.0046, 0.0044]);
    assert_eq!(doubt, "");

    let (v1, doubt) = with_count(
        &folder,
        "geonet_HSES_head.V1A",
        ["65536       0       0   65536", "65536       0       0     340"],
        "N10E",
    );
    beginning(&v1, &[0.0, 0.0, -1e-4]);
    assert!(doubt.ends_with("line 14 states 2394.8 mm/s²"), "{doubt}");
    let (v2, doubt) = with_count(&folder, "geonet_WPWS_head.V2A", ["250    5800", "250     340"], "S16W");
    assert_eq!((v2.unit, v2.time_step), (Unit::MillimetrePerSecondSquared, 0.02));
    assert!(doubt.ends_with("line 14 states 41.6 mm/s²"), "{doubt}");

    let (unam, doubt) = with_count(&folder, "unam_ACAC_head.191", ["/35600/35600/35600", "/51/51/51"], "N00E");
    beginning(&unam, &[-0.000214, -0.000103, -0.000681]);
    assert!(doubt.ends_with("line 74 states 58.7394 cm/s²"), "{doubt}");

    // The counts in these headers are those of the beginnings.
    for (name, format, count, stated) in [
        ("csmip_2014_CE58667_cut.V2", Format::Csmip, 160, "line 18 states 27.114 cm/s²"),
        ("afad_dyna12_head.asc", Format::Esm, 286, "line 40 states 1.632 cm/s²"),
    ] {
        let (record, doubt) = read_with_doubt(&folder.join("formats").join(name), &ReadOptions::default()).unwrap();
        assert_eq!((record.format, record.acceleration.len(), record.time_step), (format, count, 0.01), "{name}");
        assert!(doubt.as_ref().is_some_and(|doubt| doubt.ends_with(stated)), "{name}: {doubt:?}");
    }
}

/// Beginnings of files that once were misread or refused: each is read by its own header, or refused with the words of it.
#[test]
fn headers_of_the_second_list_are_believed() {
    let Some(folder) = shared() else { return };
    use Unit::{CentimetrePerSecondSquared as Cm, G, MetrePerSecondSquared as M};
    let path = |name: &str| folder.join("formats").join(name);
    for (name, format, unit, step, count) in [
        ("csn_chile_head.txt", Format::Columns, M, 0.005, 53),
        ("zeit_de.csv", Format::Columns, M, 0.01, 59),
        ("rspmatch2.acc", Format::Peer, G, 0.01, 300),
        ("isesd_002727xa.cor", Format::Esd, M, 0.01, 16),
    ] {
        let record = read(&path(name), &ReadOptions::default()).unwrap();
        assert_eq!((record.format, record.unit, record.time_step), (format, unit, step), "{name}");
        assert_eq!(record.acceleration.len(), count, "{name}");
        for wrong in [Cm, G, M].into_iter().filter(|other| *other != unit) {
            let error = read(&path(name), &ReadOptions { unit: Some(wrong), ..ReadOptions::default() }).unwrap_err();
            assert!(
                error.to_string().contains(&format!("the file is in {unit} but {wrong} was given")),
                "{name}: {error}"
            );
        }
        let error = read(&path(name), &ReadOptions { time_step: Some(0.04), ..ReadOptions::default() }).unwrap_err();
        assert!(
            error.to_string().contains(&format!("a time step of {step} s but 0.04 s was given")),
            "{name}: {error}"
        );
    }
    for (name, column, line, found) in [
        ("scec_s02-lf_head.bbp", Some(2), 2, "a velocity (\"N-S(cm/s)\")"),
        ("iris_tspair_velocity.txt", None, 1, "a velocity"),
        ("iris_geocsv_velocity.csv", None, 17, "a velocity"),
    ] {
        let options =
            ReadOptions { unit: Some(M), acceleration_column: column.map(Choice::Number), ..ReadOptions::default() };
        let message = read(&path(name), &options).unwrap_err().to_string();
        assert!(message.contains(&format!(", line {line}: found {found}")), "{message}");
        assert!(message.contains("but m/s² was given"), "{message}");
    }
    // The counts in these headers are those of the whole files.
    for (name, format, options, counts) in [
        ("china_csmnc_head.dat", Format::Csmnc, ReadOptions::default(), ["12800", "80"]),
        ("deepsoil_pystrata_head.txt", Format::Npts, unit_and_step(G, 0.005), ["11800", "29"]),
    ] {
        let text = std::fs::read_to_string(path(name)).unwrap();
        let message = parse_with_doubt(name, text.as_bytes(), &options).unwrap_err().to_string();
        assert!(message.contains(&format!(" values in the file, expected {}", counts[0])), "{message}");
        let (record, doubt) =
            parse_with_doubt(name, text.replacen(counts[0], counts[1], 1).as_bytes(), &options).unwrap();
        assert_eq!((record.format, record.time_step), (format, 0.005), "{name}");
        let stated = doubt.is_some_and(|doubt| doubt.ends_with("line 13 states 16.986 cm/s²"));
        assert_eq!(stated, format == Format::Csmnc, "{name}");
    }
}

/// Every file of the folder is read, or refused with one line.
#[test]
fn every_file_is_read_or_refused_in_one_line() {
    let Some(folder) = shared() else { return };
    for entry in
        ["paper", "paper_derived", "fallback", "formats"].iter().flat_map(|sub| folder.join(sub).read_dir().unwrap())
    {
        let path = entry.unwrap().path();
        if let Err(error) = read(&path, &ReadOptions::default()) {
            let message = error.to_string();
            assert!(!message.contains('\n') && message.contains("expected"), "{message}");
            println!("{message}");
        }
    }
}

/// The seeds of the fuzz target are valid files of every format, so that fuzzing passes the headers.
#[test]
fn the_seeds_of_the_fuzz_target_are_records() {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../lab/fuzz/seeds"));
    let expected = [
        ("bhrc.v1", Format::Bhrc),
        ("block.txt", Format::Peer),
        ("columns.csv", Format::Columns),
        ("csmnc.dat", Format::Csmnc),
        ("esd.cor", Format::Esd),
        ("npts.txt", Format::Npts),
        ("cosmos.v2", Format::Cosmos),
        ("csmip.v1", Format::Csmip),
        ("csmip.v2", Format::Csmip),
        ("cwb.dat", Format::Cwb),
        ("esm.asc", Format::Esm),
        ("geonet.v2a", Format::Geonet),
        ("jma.csv", Format::Jma),
        ("knet.csv", Format::Knet),
        ("knet.ew", Format::Knet),
        ("nsmn.txt", Format::Nsmn),
        ("peer.at2", Format::Peer),
        ("renadic.v1", Format::Renadic),
        ("smc.smc", Format::Smc),
        ("time.txt", Format::Columns),
        ("unam.191", Format::Unam),
        ("usc.s0a", Format::Usc),
    ];
    assert_eq!(std::fs::read_dir(folder).unwrap().count(), expected.len());
    for (name, format) in expected {
        let bare = matches!(name, "block.txt" | "time.txt" | "npts.txt");
        let options = if bare { unit_and_step(Unit::G, 0.01) } else { ReadOptions::default() };
        let several = matches!(format, Format::Cwb | Format::Jma | Format::Nsmn | Format::Unam) || name == "knet.csv";
        let options = ReadOptions { channel: several.then_some(Choice::Number(2)), ..options };
        assert_eq!(read(&folder.join(name), &options).unwrap().format, format, "{name}");
    }
}
