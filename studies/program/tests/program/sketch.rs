//! Sketches of a block, and the values beside them.

use serde_json::Value;

use crate::program::{files, refused, rocking, stdout, text};

/// Texts of a drawing, without the markup of their subscripts.
fn texts(svg: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(svg).unwrap();
    let content = |text: roxmltree::Node| -> String {
        text.descendants().filter(roxmltree::Node::is_text).map(|part| part.text().unwrap().replace('\n', "")).collect()
    };
    document.descendants().filter(|node| node.has_tag_name("text")).map(content).collect()
}

/// The sketch shows the numbers that the user typed, and those of tan α = 0.8/3.2 and K = M ω_v²/2.
#[test]
fn sketches_show_the_dimensions_of_the_block() {
    let folder = tempfile::tempdir().unwrap();
    let size = ["--width", "0.8", "--height", "3.2", "--stiffness", "1e7", "--damping", "4e4", "--mass", "4000"];
    let printed = stdout(folder.path(), &[&["sketch", "--plot", "block.svg"], &size[..]].concat());
    assert!(printed.contains("K = 1.0000e7 N/m") && printed.contains("written       block.svg"), "{printed}");
    let svg = std::fs::read_to_string(folder.path().join("block.svg")).unwrap();
    let texts = texts(&svg);
    for expected in [
        "2b = 0.8 m",
        "h = 1.6 m",
        "2h = 3.2 m",
        "R0 = 1.649 m",
        "α = 14.04°",
        "α = 0.245 rad = 14.04°",
        "M = 4000 kg",
        "K = 10 MN/m, C = 40 kN s/m",
        "K",
        "C",
    ] {
        assert!(texts.iter().any(|text| text == expected), "{expected} is not in {texts:?}");
    }
    let eta = (2.0 * 1e7 / 4000.0_f64).sqrt() / (0.75 * 9.81 / 0.4_f64.hypot(1.6)).sqrt();
    assert!(texts.iter().any(|text| text.starts_with(&format!("η = {eta:.2}, ξv = "))), "{eta}: {texts:?}");
}

/// A block in space has its lengths and the names of its feet, and is refused what it does not have.
#[test]
fn blocks_in_space_are_sketched_in_axonometry() {
    let folder = tempfile::tempdir().unwrap();
    let size = "sketch --width 0.8 --depth 1.2 --height 3.2 --eta 60 --mass 7800 --friction 0.4 --plot block.svg";
    let printed = stdout(folder.path(), &size.split(' ').collect::<Vec<_>>());
    assert!(printed.starts_with("block         in space, 0.8 m × 1.2 m"), "{printed}");
    // g tan α_edge = 9.81 · 0.4/1.6.
    assert!(printed.contains("rocks         beyond g tan α_edge = 2.4525 m/s² over the nearest edge"), "{printed}");
    let texts = texts(&std::fs::read_to_string(folder.path().join("block.svg")).unwrap());
    for expected in [
        "2b = 0.8 m",
        "depth = 1.2 m",
        "h = 1.6 m",
        "2h = 3.2 m",
        "SW",
        "NW",
        "SE",
        "NE",
        "M = 7800 kg",
        "friction μ = 0.4",
    ] {
        assert!(texts.iter().any(|text| text == expected), "{expected} is not in {texts:?}");
    }
    assert!(texts.iter().any(|text| text.starts_with("αedge = 0.245 rad = 14.04°")), "{texts:?}");
    let expected =
        "--kappa has no effect without one of --depth, --depth-ratio, --base, --feet, which make a block in space";
    refused(folder.path(), &["sketch", "--kappa", "2"], &[expected]);
}

/// A rigid base has neither supports nor their values.
#[test]
fn a_rigid_base_has_no_supports() {
    let folder = tempfile::tempdir().unwrap();
    let printed = stdout(
        folder.path(),
        &["sketch", "--alpha", "0.25", "--foundation", "rigid", "--plot", "-", "--plot-format", "svg"],
    );
    let texts = texts(&printed);
    assert!(texts.iter().any(|text| text == "rigid base, e = 0.9082"), "{texts:?}");
    assert!(texts.iter().all(|text| text != "K" && text != "C" && !text.contains('η')), "{texts:?}");
    assert_eq!(files(folder.path()), [""; 0]);
}

/// Eccentricity, friction and ties are drawn; a body with only the height of its centre of mass has no height.
#[test]
fn sketches_show_eccentricity_friction_and_ties() {
    let folder = tempfile::tempdir().unwrap();
    let body = "--width 0.8 --center-height 1.0 --mass 500 --foundation rigid --eccentricity -0.1 --friction 0.25";
    let ties = "--tie block_x=-0.4,block_z=1.8,ground_x=-1.6,stiffness=2.5e6,slack=0.005 \
                --tie block_z=0.2,ground_z=-30,stiffness=1e5,strength=4e4";
    let options = format!("sketch --plot block.svg {body} {ties}");
    let printed = stdout(folder.path(), &options.split_whitespace().collect::<Vec<_>>());
    assert!(!printed.contains("rocks ") && !printed.contains("slides "), "{printed}");
    let texts = texts(&std::fs::read_to_string(folder.path().join("block.svg")).unwrap());
    for expected in [
        "ex = −0.1 m",
        "h = 1 m",
        "αL = 16.7°",
        "αR = 26.57°",
        "αL = 0.2915 rad = 16.7°",
        "friction μ = 0.25",
        "tie 1: (−0.4, 1.8) to (−1.6, 0) m",
        "k = 2.5 MN/m, slack 0.005 m",
        "tie 2: (0, 0.2) to (0, −30) m",
        "k = 100 kN/m, strength 40 kN",
        "1",
        "2",
    ] {
        assert!(texts.iter().any(|text| text == expected), "{expected} is not in {texts:?}");
    }
    assert!(texts.iter().all(|text| !text.contains("2h") && !text.contains("high")), "{texts:?}");
}

/// The summary has the values in full precision, by the names of the FMU.
#[test]
fn values_are_printed_as_json() {
    let folder = tempfile::tempdir().unwrap();
    let of = |options: &[&str]| -> Value {
        let output = rocking(folder.path(), &[&["sketch", "--json"], options].concat());
        assert!(output.status.success() && output.stderr.is_empty(), "{}", text(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let values = of(&["--alpha", "0.2", "--p", "1.5", "--eta", "60", "--xi-v", "0.1"]);
    assert_eq!(
        (values["command"].as_str(), values["written"]["plot"].as_str()),
        (Some("sketch"), Some("out/sketch.png"))
    );
    assert_eq!((values["block"]["alpha"].as_f64(), values["block"]["eta"].as_f64()), (Some(0.2), Some(60.0)));
    let close = |name: &str, expected: f64| (values[name].as_f64().unwrap() / expected - 1.0).abs() < 1e-14;
    // omega_v = 90 rad/s and M = 1000 kg.
    assert!(close("K", 4.05e6) && close("C", 9000.0) && close("delta_s", 9.81 / 8100.0), "{values}");
    assert!(close("rocking_acceleration", 9.81 * 0.2_f64.tan()), "{values}");
    let png = std::fs::read(folder.path().join("out/sketch.png")).unwrap();
    assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
    let rigid = of(&["--foundation", "rigid"]);
    assert!(rigid["K"].is_null() && rigid["block"]["eta"].is_null() && rigid["block"]["e"].is_f64(), "{rigid}");
}

/// A journal wants the caption alone.
#[test]
fn a_title_replaces_the_heading() {
    let folder = tempfile::tempdir().unwrap();
    let drawn = |title: &[&str]| {
        let options =
            ["sketch", "--width", "0.8", "--height", "3.2", "--eta", "60", "--plot", "-", "--plot-format", "svg"];
        stdout(folder.path(), &[&options[..], title].concat())
    };
    let height = |svg: &str| -> u32 {
        roxmltree::Document::parse(svg).unwrap().root_element().attribute("height").unwrap().parse().unwrap()
    };
    let [own, other, none] = [&[][..], &["--title", "Figure 1"], &["--title", ""]].map(drawn);
    assert!(texts(&own)[0].starts_with("Block 0.8 m wide"), "{own}");
    assert_eq!(texts(&other)[0], "Figure 1");
    assert_eq!((texts(&other)[1..].to_vec(), height(&other)), (texts(&own)[1..].to_vec(), height(&own)));
    assert_eq!((texts(&none), height(&none)), (texts(&own)[1..].to_vec(), height(&own) - 50));
}

/// Options are refused as by `simulate`, and nothing is written.
#[test]
fn options_without_effect_and_bad_blocks_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (options, message) in [
        ("--foundation rigid --eta 40", "--eta has no effect on a rigid base"),
        ("--width 1 --alpha 0.2", "--alpha has no effect with --width"),
        ("--alpha 2", "alpha = 2 is not valid"),
        ("--plot block.pdf", "expected a picture as .svg or .png"),
        ("--plot-format svg", "--plot-format has no effect without --plot"),
        ("--title x", "--title has no effect without --plot"),
    ] {
        let arguments: Vec<&str> = std::iter::once("sketch").chain(options.split(' ')).collect();
        refused(folder.path(), &arguments, &[message]);
    }
    assert_eq!(files(folder.path()), [""; 0]);
}
