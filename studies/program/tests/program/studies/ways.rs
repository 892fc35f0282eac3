//! Clouds, stripes, and the levels at which ties break.

use std::fs;

use serde_json::Value;

use crate::program::{Table, refused, stdout};

fn json(folder: &std::path::Path, arguments: &str) -> Value {
    let arguments: Vec<&str> = arguments.split(' ').chain(["--json"]).collect();
    serde_json::from_str(&stdout(folder, &arguments)).unwrap()
}

/// Rotations on 2 PGV² under three motions, which share a factor each, and blocks that overturn.
fn cloud_table() -> String {
    let mut text = "row,record,PGV [m/s],PGA [m/s2],outcome,peak.theta/alpha [1]\n".to_string();
    for row in 0..24 {
        let pgv = 0.1 + 0.03 * f64::from(row);
        let factor = [0.9, 1.0, 1.2][row as usize % 3];
        let overturns = row > 14 && row % 2 == 0;
        let (outcome, peak) = if overturns { ("overturned", 9.0) } else { ("completed", 2.0 * pgv * pgv * factor) };
        text += &format!("{row},r{},{pgv},{},{outcome},{peak}\n", row % 3, 10.0 * pgv / factor);
    }
    text
}

/// The printed numbers are those of the JSON, the table of the curve meets both ends, and only one measure is drawn.
#[test]
fn a_cloud_is_a_line_with_its_probabilities() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("t.csv"), cloud_table()).unwrap();
    let found = json(folder, "cloud t.csv --im PGV --limit 0.5 --csv curve.csv --plot c.svg");
    let of = &found["clouds"][0];
    let [a, b] = [0, 1].map(|i| of["coefficients"][i].as_f64().unwrap());
    assert!((a.exp() - 2.0).abs() < 0.2 && (b - 2.0).abs() < 0.1, "{found}");
    assert_eq!(found["intervals"], "clustered by 3 motions");
    assert_eq!((&of["overturning"]["exceeded"], &of["overturning"]["rows"]), (&4.into(), &24.into()));
    assert_eq!(of["rows"], 20);
    let curve = Table::read(&folder.join("curve.csv"));
    let measures = curve.column("PGV");
    assert_eq!((measures.len(), measures[0], measures[99]), (100, 0.1, 0.1 + 0.03 * 23.0));
    for row in [0, 50, 99] {
        let exact = (a + b * curve.number(row, "PGV").ln()).exp();
        assert!((curve.number(row, "median") / exact - 1.0).abs() < 1e-12);
        let [rocks, falls, exceeds] =
            ["P(rocks)", "P(overturned)", "P(theta/alpha>0.5)"].map(|name| curve.number(row, name));
        assert!(rocks == 1.0 && exceeds >= falls, "{rocks} {falls} {exceeds}");
    }
    let picture = fs::read_to_string(folder.join("c.svg")).unwrap();
    assert!(picture.contains("peak |θ|/α") && picture.contains("4 of 24 runs overturn"));
    let text = stdout(folder, &["cloud", "t.csv", "--im", "PGV", "--im", "PGA"]);
    // PGA has the factors of the motions the wrong way round: it is the less efficient measure.
    let both = json(folder, "cloud t.csv --im PGV --im PGA");
    let beta = |i: usize| both["clouds"][i]["beta"].as_f64().unwrap();
    assert!(beta(0) < 0.7 * beta(1), "{both}");
    assert!(text.contains("20 runs rock and stand, of 20 that stand"), "{text}");
    refused(folder, &["cloud", "t.csv", "--im", "PGV", "--im", "PGA", "--plot", "c.svg"], &["--plot with 2 measures"]);
    let slip = ["cloud", "t.csv", "--im", "PGV", "--limit", "slip:0.1"];
    refused(folder, &slip, &["--limit slip>0.1; expected overturned, or a rotation such as 0.5"]);
    refused(
        folder,
        &["cloud", "t.csv", "--im", "PGV", "--ci", "1"],
        &["--ci = 1; expected a number above 0 and below 1"],
    );
}

/// Counts are the rows that they count: the curve of both is the same, and the levels have the counts.
#[test]
fn stripes_are_counted_at_their_levels() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let counts = [(0.2, 10, 1), (0.4, 10, 4), (0.8, 9, 7)];
    let (mut of_levels, mut of_rows) = ("PGV [m/s],runs,exceeded\n".to_string(), "PGV [m/s],outcome\n".to_string());
    for (level, runs, exceeded) in counts {
        of_levels += &format!("{level},{runs},{exceeded}\n");
        for run in 0..runs {
            of_rows += &format!("{level},{}\n", if run < exceeded { "overturned" } else { "completed" });
        }
    }
    fs::write(folder.join("counts.csv"), of_levels).unwrap();
    fs::write(folder.join("rows.csv"), of_rows).unwrap();
    let [counted, rows] = ["counts", "rows"]
        .map(|name| json(folder, &format!("stripes {name}.csv --im PGV --csv {name}-levels.csv --plot s.png")));
    assert_eq!((&counted["measures"], &counted["levels"]), (&rows["measures"], &rows["levels"]));
    let fragility = json(folder, "fragility rows.csv --im PGV");
    assert_eq!(rows["measures"], fragility["measures"]);
    let table = Table::read(&folder.join("counts-levels.csv"));
    for (row, (level, runs, exceeded)) in counts.into_iter().enumerate() {
        let [found, of, does, fraction] = ["PGV", "runs", "exceeded", "fraction"].map(|name| table.number(row, name));
        assert_eq!(
            (found, of, does, fraction),
            (level, f64::from(runs), f64::from(exceeded), f64::from(exceeded) / f64::from(runs))
        );
        let [low, middle, high] =
            ["probability.low", "probability", "probability.high"].map(|name| table.number(row, name));
        assert!(low < middle && middle < high, "{low} {middle} {high}");
    }
    fs::write(folder.join("t.csv"), cloud_table()).unwrap();
    refused(
        folder,
        &["stripes", "t.csv", "--im", "PGV"],
        &["t.csv: found 24 levels of PGV in 24 rows; expected stripes"],
    );
    fs::write(folder.join("wrong.csv"), "PGV,runs,exceeded\n0.2,10,11\n").unwrap();
    refused(folder, &["stripes", "wrong.csv", "--im", "PGV"], &["wrong.csv: 11 of 10 runs are exceeded in row 0"]);
}

/// A tie's ends approach by the horizontal way of its end on the block, whether it pulls or not, and each curve names the level of its
/// first break.
#[test]
fn ties_approach_and_break_at_a_level() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let study = format!(
        "[study]
design = \"grid\"
levels = {{ im = \"PGV\", values = [0.1, 0.3, 0.6, 1.2] }}
[parameters]
foundation = \"rigid\"
alpha = 0.15
p = 2
mass = 1000
tie_1 = {{ block_z = 3.6, ground_z = 3.6, ground_x = -2, stiffness = 1e5, strength = 400 }}
tie_2 = {{ block_z = 3.6, ground_z = 3.6, ground_x = 2, stiffness = 1e5, strength = 400 }}
[[records]]
horizontal = \"{}\"
",
        concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/records/0111a.smc")
    );
    fs::write(folder.join("study.toml"), study).unwrap();
    let found = json(folder, "ida study.toml --csv runs.csv");
    let table = Table::read(&folder.join("runs.csv"));
    let (levels, broken) = (table.column("PGV"), table.column("ties.broken"));
    let first = levels.iter().zip(&broken).find(|(_, broken)| **broken > 0.0).map(|(level, _)| *level);
    assert_eq!(found["capacities"][0]["breaks"].as_f64(), first);
    assert!(first.is_some_and(|first| first > 0.1), "{broken:?}");
    let text = stdout(folder, &["ida", "study.toml", "--csv", "again.csv"]);
    let shown = format!("breaks        first at {} m/s, in 1 of 1 curves", first.unwrap());
    assert!(text.contains(&shown), "{text}");
    for row in 0..levels.len() {
        let [one, other] = [1, 2].map(|tie| table.number(row, &format!("peak.tie_{tie}.shortening")));
        let rotation = 0.15 * table.number(row, "peak.theta/alpha");
        if table.get(row, "outcome") == "completed" {
            // The greater rotation is to the side of the greater approach; a point 3.6 m above a corner moves by as much, less the second order.
            let way = one.max(other) / (3.6 * rotation.sin());
            assert!((0.9..1.1).contains(&way) || rotation < 1e-3, "row {row}: {one} {other} {rotation}");
        }
    }
}
