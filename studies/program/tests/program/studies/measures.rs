//! Comparisons of measures by `rocking fragility`.

use crate::program::{rocking, text};

/// A measure that separates both classes has no curve; the others are compared all the same, and rows without one are counted.
#[test]
fn a_separable_measure_does_not_end_a_comparison() {
    let folder = tempfile::tempdir().unwrap();
    let rows = ["0.2,1,completed", "0.5,2,completed", "0.4,3,overturned", "0.9,4,overturned", ",5,overturned"];
    let rows: String = rows.iter().enumerate().map(|(i, row)| format!("{i},r{i},{row},0.1\n")).collect();
    let head = "row,record,PGV [m/s],PGA [m/s2],outcome,peak.theta/alpha [1]\n";
    std::fs::write(folder.path().join("t.csv"), format!("{head}{rows}")).unwrap();
    let output = rocking(folder.path(), &["fragility", "t.csv", "--im", "PGA", "--im", "PGV", "--json"]);
    let (found, warned) = (text(&output.stdout), text(&output.stderr));
    let found: serde_json::Value = serde_json::from_str(&found).unwrap();
    assert_eq!(found["measures"].as_array().map(Vec::len), Some(1), "{found}");
    assert!(warned.contains("t.csv: PGA: found separable data"), "{warned}");
    assert!(warned.contains("PGV [m/s]: 1 rows without the measure are left out of the curve"), "{warned}");
}
