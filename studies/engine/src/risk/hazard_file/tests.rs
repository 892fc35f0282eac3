//! Files of each kind, and kinds with which they must not be confused.

use super::*;

fn options() -> HazardOptions {
    HazardOptions { measure: None, unit: None, site: None, years: None, kind: None, gravity: 10.0 }
}

#[track_caller]
fn assert_curve(found: &HazardCurve, measure: &str, unit: &str, levels: &[f64], rates: &[f64]) {
    assert_eq!((found.measure.as_deref(), found.unit.as_deref()), (Some(measure), Some(unit)));
    for (found, exact) in [(found.levels(), levels), (found.rates(), rates)] {
        assert_eq!(found.len(), exact.len());
        for (found, exact) in found.iter().zip(exact) {
            assert!((found / exact - 1.0).abs() < 1e-14, "{found}, exactly {exact}");
        }
    }
}

#[test]
fn two_columns_are_rates_or_probabilities() {
    let text = "# any remark\nPGA [g],rate [1/year]\n0.1, 1e-2\n0.2,1e-3\n";
    assert_curve(&read_hazard("h.csv", text, &options()).unwrap(), "PGA", "m/s2", &[1.0, 2.0], &[1e-2, 1e-3]);
    let text = "SA(0.50) [cm/s2],POE\n10,0.5\n20,0.1\n";
    let refused = read_hazard("h.csv", text, &options()).unwrap_err().to_string();
    assert_eq!(refused, "found the column `POE`; expected the investigation time of its probabilities");
    let found = read_hazard("h.csv", text, &HazardOptions { years: Some(50.0), ..options() }).unwrap();
    let rates = [0.5_f64.ln() / -50.0, 0.9_f64.ln() / -50.0];
    assert_curve(&found, "Sa(0.5 s)", "m/s2", &[0.1, 0.2], &rates);
}

#[test]
fn an_investigation_time_must_agree_with_the_file() {
    let of = |name: &str, text: &str| read_hazard(name, text, &HazardOptions { years: Some(50.0), ..options() });
    let refused = |name: &str, text: &str| of(name, text).unwrap_err().to_string();
    for heading in ["rate [1/year]", "Annual frequency", "lambda [1/yr]"] {
        let text = format!("PGA [g],{heading}\n0.1,1e-2\n0.2,1e-3\n");
        let expected = format!(
            "found an investigation time of 50 years for the column `{heading}`; expected none, as it holds annual rates"
        );
        assert_eq!(refused("h.csv", &text), expected);
    }
    let curve = r#"{"response": [{"metadata": {"imt": {"value": "PGA"}, "xvalues": [0.01, 0.1]}, "data": [{"yvalues": [0.02, 0.001]}]}]}"#;
    assert!(refused("h.json", curve).ends_with("expected none, as it holds annual rates"));
    let text = "# investigation_time=475.0, imt='PGA'\nlon,lat,depth,poe-0.1,poe-0.2\n0,0,0,0.2,0.1\n";
    let expected = "found an investigation time of 50 years; expected 475, as the file says";
    assert_eq!(refused("h.csv", text), expected);
    assert!(of("h.csv", &text.replace("475.0", "50")).is_ok());
}

#[test]
fn a_unit_must_agree_with_the_heading() {
    let of = |heading: &str, unit: &str| {
        let text = format!("{heading},rate\n0.1,1e-2\n0.2,1e-3\n");
        read_hazard("h.csv", &text, &HazardOptions { unit: Some(unit.into()), ..options() })
    };
    let refused = of("PGA [g]", "cm/s2").unwrap_err().to_string();
    assert_eq!(refused, "found the unit cm/s2; expected g, as the file says");
    let found = of("PGA [cm/s2]", "gal").unwrap();
    assert_curve(&found, "PGA", "m/s2", &[1e-3, 2e-3], &[1e-2, 1e-3]);
    let found = of("PGA", "g").unwrap();
    assert_curve(&found, "PGA", "m/s2", &[1.0, 2.0], &[1e-2, 1e-3]);
}

/// A file of one curve has no sites to choose from.
#[test]
fn a_site_must_be_one_of_the_file() {
    let at = HazardOptions { site: Some("0,0".into()), ..options() };
    let reply = r#"{"response": [{"metadata": {"imt": {"value": "PGA"}, "xvalues": [0.01, 0.1]}, "data": [{"yvalues": [0.02, 0.001]}]}]}"#;
    for (name, text) in [("h.csv", "PGA [g],rate\n0.1,1e-2\n0.2,1e-3\n"), ("h.json", reply)] {
        assert!(read_hazard(name, text, &options()).is_ok());
        let refused = read_hazard(name, text, &at).unwrap_err().to_string();
        assert_eq!(refused, "found the site 0,0; expected none, as the file names no sites");
    }
}

#[test]
fn an_investigation_time_is_above_zero() {
    let text = "PGA [g],POE\n0.1,0.5\n0.2,0.1\n";
    for years in [0.0, -50.0, f64::NAN, f64::INFINITY] {
        let refused = read_hazard("h.csv", text, &HazardOptions { years: Some(years), ..options() }).unwrap_err();
        let found = format!("found an investigation time of {years} years; expected a number above 0");
        assert_eq!(refused.to_string(), found);
    }
}

#[test]
fn other_exports_of_openquake_are_named() {
    let of = |text: &str| read_hazard("h", text, &options()).unwrap_err().to_string();
    let nrml =
        "<?xml version=\"1.0\"?>\n<nrml xmlns=\"http://openquake.org/xmlns/nrml/0.4\"><uniformHazardSpectra/></nrml>";
    assert_eq!(
        of(nrml),
        "found XML, as NRML with uniform hazard spectra of OpenQuake; expected its export of hazard curves as CSV"
    );
    let spectra = "# investigation_time=50.0\nlon,lat,0.1~PGA,0.1~SA(0.2)\n0,0,0.3,0.7\n";
    assert_eq!(of(spectra), "found uniform hazard spectra, by the column `0.1~PGA`; expected hazard curves");
}

#[test]
fn levels_of_probability_1_are_left_out_where_they_are() {
    let text = "PGA [g],POE\n0.4,0.1\n0.3,0.2\n0.2,1\n";
    let refused = read_hazard("h.csv", text, &HazardOptions { years: Some(1.0), ..options() }).unwrap_err();
    assert_eq!(refused.to_string(), "found 0.3 as level 2; expected levels that increase, here above 0.4");
}

/// The layout of OpenQuake 3.18 and later, and that of earlier versions.
#[test]
fn openquake_exports_have_probabilities_in_an_investigation_time() {
    let comment =
        "#,,,,,\"generated_by='OpenQuake engine 3.20.0', kind='mean', investigation_time=50.0, imt='SA(1.0)'\"";
    let doubled = "#,,,,,\"generated_by='OpenQuake engine 3.20.0', investigation_time=50.0, imt=\"\"SA(1.0)\"\"\"";
    for comment in [
        comment,
        doubled,
        "# kind='mean', investigation_time=50.0, imt='SA(1.0)'",
        "# kind=\"mean\", investigation_time=50.0, imt=\"SA(1.0)\"",
    ] {
        let rows = "0.00000,0.00000,0.0,1.000000E+00,5.000000E-01,1.000000E-01,0.000000E+00\n\
                    1.00000,2.50000,0.0,9.000000E-01,2.000000E-01,1.000000E-01,5.000000E-02\n";
        let text = format!("{comment}\nlon,lat,depth,poe-0.0050000,poe-0.1000000,poe-0.4000000,poe-0.6000000\n{rows}");
        let of = |site: &str| read_hazard("h.csv", &text, &HazardOptions { site: Some(site.into()), ..options() });
        let found = of("0, 0").unwrap();
        let rate = |poe: f64| -(1.0 - poe).ln() / 50.0;
        assert_curve(&found, "Sa(1 s)", "m/s2", &[1.0, 4.0], &[rate(0.5), rate(0.1)]);
        assert_eq!(
            found.remarks,
            [
                "1 levels have a probability of 1, and so no rate, and were left out",
                "1 levels from 0.6 on have a rate of 0 and were left out"
            ]
        );
        let rates = [0.9, 0.2, 0.1, 0.05].map(rate);
        assert_curve(&of("1,2.5").unwrap(), "Sa(1 s)", "m/s2", &[0.05, 1.0, 4.0, 6.0], &rates);
        let refused = read_hazard("h.csv", &text, &options()).unwrap_err().to_string();
        assert_eq!(refused, "found 2 sites; expected the choice of one: 0,0; 1,2.5");
        assert!(of("3,3").unwrap_err().to_string().starts_with("found no site 3,3; expected one such as 0,0"));
    }
    let text = "lon,lat,depth,poe-0.1,poe-0.2\n0,0,0,0.2,0.1\n";
    assert!(read_hazard("h.csv", text, &options()).unwrap_err().to_string().contains("no investigation_time"));
}

/// The layout of one file for all measures; hazard maps have such columns for probabilities.
#[test]
fn openquake_has_all_measures_in_a_file() {
    let comment = "#,,,\"generated_by='OpenQuake engine', kind='mean', investigation_time=50.0\"";
    let text = format!(
        "{comment}\nlon,lat,depth,PGA-0.005,PGA-0.1,PGA-0.4,PGA-1E+00,SA(0.2)-0.01,SA(0.2)-0.1,SA(0.2)-0.5,SA(0.2)-1.5\n\
         0,0,0,1.0,0.5,0.1,0.01,0.9,0.6,0.2,0.02\n1,2,0,0.8,0.4,0.05,0.005,0.8,0.5,0.1,0.01\n"
    );
    let of = |measure: Option<&str>, site: &str| {
        let options = HazardOptions { measure: measure.map(Into::into), site: Some(site.into()), ..options() };
        read_hazard("h.csv", &text, &options)
    };
    let rate = |poe: f64| -(1.0 - poe).ln() / 50.0;
    assert_curve(&of(Some("PGA"), "0,0").unwrap(), "PGA", "m/s2", &[1.0, 4.0, 10.0], &[0.5, 0.1, 0.01].map(rate));
    let rates = [0.8, 0.5, 0.1, 0.01].map(rate);
    assert_curve(&of(Some("SA(0.2)"), "1,2").unwrap(), "Sa(0.2 s)", "m/s2", &[0.1, 1.0, 5.0, 15.0], &rates);
    let refused = of(None, "0,0").unwrap_err().to_string();
    assert_eq!(refused, "found hazard curves of PGA, Sa(0.2 s); expected the choice of one");
    let refused = of(Some("PGV"), "0,0").unwrap_err().to_string();
    assert_eq!(refused, "found hazard curves of PGA, Sa(0.2 s); expected one of PGV");
    let map = format!("{comment}\nlon,lat,PGA-0.1,PGA-0.02\n0,0,0.2,0.4\n");
    assert_eq!(
        read_hazard("map.csv", &map, &options()).unwrap_err().to_string(),
        "found 2 columns of PGA, as in a map for some probabilities; expected a hazard curve of 4 levels or more"
    );
}

#[test]
fn openquake_in_aelo_mode_has_rows_of_measures() {
    let comment =
        "#,,\"generated_by='OpenQuake engine 3.20.0', lon=-122.4, lat=37.75, kind='mean', investigation_time=1.0\"";
    let rows = "PGA,1.0E-01,1.0E+00\nPGA,2.0E-01,5.0E-01\nPGA,4.0E-01,1.0E-01\nSA(1.0),1.0E-01,3.0E-01\nSA(1.0),2.0E-01,2.0E-01\n";
    let text = format!("{comment}\nimt,iml,poe\n{rows}");
    let of = |measure: &str| HazardOptions { measure: Some(measure.into()), ..options() };
    let rate = |poe: f64| -(1.0 - poe).ln();
    let found = read_hazard("h.csv", &text, &of("PGA")).unwrap();
    assert_curve(&found, "PGA", "m/s2", &[2.0, 4.0], &[0.5, 0.1].map(rate));
    assert_eq!(found.remarks, ["1 levels have a probability of 1, and so no rate, and were left out"]);
    let at = HazardOptions { site: Some("-122.4, 37.75".into()), ..of("Sa(1 s)") };
    assert_curve(&read_hazard("h.csv", &text, &at).unwrap(), "Sa(1 s)", "m/s2", &[1.0, 2.0], &[0.3, 0.2].map(rate));
    let refused = |text: &str, options: &HazardOptions| read_hazard("h.csv", text, options).unwrap_err().to_string();
    assert_eq!(refused(&text, &options()), "found hazard curves of PGA, Sa(1 s); expected the choice of one");
    let elsewhere = HazardOptions { site: Some("0,0".into()), ..of("PGA") };
    assert_eq!(refused(&text, &elsewhere), "found the site 0,0; expected -122.4,37.75, the only one of the file");
    let years = HazardOptions { years: Some(50.0), ..of("PGA") };
    assert_eq!(refused(&text, &years), "found an investigation time of 50 years; expected 1, as the file says");
    let silent = refused(&format!("imt,iml,poe\n{rows}"), &of("PGA"));
    assert_eq!(silent, "found no investigation_time in the comment; expected the years of the probabilities");
    assert!(read_hazard("h.csv", &format!("imt,iml,poe\n{rows}"), &years).is_ok());
}

/// The heading or a comment of a table names the time of its probabilities.
#[test]
fn two_columns_may_name_their_time() {
    let of = |text: &str, years| read_hazard("h.csv", text, &HazardOptions { years, ..options() });
    let rows = "0.1,0.5\n0.2,0.1\n";
    let rates = [0.5_f64.ln() / -475.0, 0.9_f64.ln() / -475.0];
    for heading in
        ["PGA [g],PoE in 475 years", "PGA [g],poe_475years", "PGA [g],poe_475yr", "PGA [g],probability [475 yr]"]
    {
        let text = format!("{heading}\n{rows}");
        assert_curve(&of(&text, None).unwrap(), "PGA", "m/s2", &[1.0, 2.0], &rates);
        let refused = of(&text, Some(50.0)).unwrap_err().to_string();
        assert_eq!(refused, "found an investigation time of 50 years; expected 475, as the file says");
    }
    let text = format!("# investigation_time=475\nPGA [g],PoE\n{rows}");
    assert_curve(&of(&text, None).unwrap(), "PGA", "m/s2", &[1.0, 2.0], &rates);
    assert!(of(&text, Some(50.0)).is_err());
    assert!(of(&format!("PGA [g],PoE\n{rows}"), None).is_err());
    // A rate names a year, too.
    assert_eq!(of(&format!("PGA [g],rate [1/year]\n{rows}"), None).unwrap().rates(), [0.5, 0.1]);
}

#[test]
fn nshmp_haz_tables_have_a_row_for_each_site_and_a_folder_for_each_measure() {
    let text = "name,lon,lat,0.005,0.05,0.5\nOakland CA,-122.25,37.80,2e-3,1e-3,1e-4\nSan Jose CA,-121.90,37.35,1e-3,1e-4,0.0\n";
    let of = |site: &str| HazardOptions { site: Some(site.into()), ..options() };
    let found = read_hazard("curves/SA0P2/total.csv", text, &of("san jose ca")).unwrap();
    assert_curve(&found, "Sa(0.2 s)", "m/s2", &[0.05, 0.5], &[1e-3, 1e-4]);
    let found = read_hazard("total.csv", text, &HazardOptions { measure: Some("PGV".into()), ..of("-122.25,37.8") });
    assert_curve(&found.unwrap(), "PGV", "m/s", &[5e-5, 5e-4, 5e-3], &[2e-3, 1e-3, 1e-4]);
}

/// The replies of nshmp-haz-ws and of the service that followed it.
#[test]
fn usgs_services_reply_with_annual_rates() {
    let old = r#"{"status": "success", "response": [{"metadata": {"imt": {"value": "SA1P0", "display": "1.00 Second"},
        "xlabel": "Ground Motion (g)", "xvalues": [0.01, 0.1], "ylabel": "Annual Frequency of Exceedence"},
        "data": [{"component": "Fault", "yvalues": [1, 1]}, {"component": "Total", "yvalues": [0.02, 0.001]}]}]}"#;
    assert_curve(&read_hazard("h.json", old, &options()).unwrap(), "Sa(1 s)", "m/s2", &[0.1, 1.0], &[0.02, 0.001]);
    let new = r#"{"status": "success", "response": {"hazardCurves": [
        {"imt": {"value": "PGA"}, "data": [{"component": "Total", "values": {"xs": [0.01, 0.1], "ys": [0.03, 0.002]}}]},
        {"imt": {"value": "SA0P2"}, "data": [{"component": "Total", "values": {"xs": [0.1, 0.2], "ys": [0.3, 0.2]}}]}]}}"#;
    let of = |name: &str| HazardOptions { measure: Some(name.into()), ..options() };
    assert_curve(&read_hazard("h.json", new, &of("PGA")).unwrap(), "PGA", "m/s2", &[0.1, 1.0], &[0.03, 0.002]);
    assert_curve(&read_hazard("h.json", new, &of("Sa(0.2 s)")).unwrap(), "Sa(0.2 s)", "m/s2", &[1.0, 2.0], &[0.3, 0.2]);
    let refused = |text: &str, options: &HazardOptions| read_hazard("h.json", text, options).unwrap_err().to_string();
    assert_eq!(refused(new, &options()), "found hazard curves of PGA, Sa(0.2 s); expected the choice of one");
    assert_eq!(refused(new, &of("PGV")), "found hazard curves of PGA, Sa(0.2 s); expected one of PGV");
    assert!(refused("{}", &options()).starts_with("found JSON without hazard curves; expected the reply"));
    assert!(refused("{", &options()).ends_with("expected JSON"));
}

#[test]
fn other_files_are_refused_with_the_content_found() {
    let refused = |text: &str| read_hazard("h.csv", text, &options()).unwrap_err().to_string();
    assert!(refused("0.1,0.2\n0.2,0.1\n").starts_with("found `0.1,0.2` in the first line; expected a heading"));
    assert!(refused("a,b,c\n1,2,3\n").starts_with("found 3 columns; expected a heading"));
    assert_eq!(refused("PGA [g],rate\n0.1,much\n"), "found `much` in rate; expected a number");
    let other = HazardOptions { measure: Some("PGV".into()), ..options() };
    let refused = read_hazard("h.csv", "PGA [g],rate\n0.1,0.2\n0.2,0.1\n", &other).unwrap_err().to_string();
    assert_eq!(refused, "found a hazard curve of PGA; expected one of PGV");
}

/// A quantile of the hazard is no mean: its rates are lower or higher by factors.
#[test]
fn curves_of_openquake_are_the_mean_unless_another_kind_is_asked_for() {
    let file = |kind: &str| {
        format!(
            "#,,,,,\"generated_by='OpenQuake engine 3.20.0', kind='{kind}', investigation_time=50.0, imt='PGA'\"\n\
             lon,lat,depth,poe-0.1,poe-0.2,poe-0.4,poe-0.8\n1,2,0,0.1,0.05,0.01,0.001\n"
        )
    };
    let read = |found: &str, wanted: Option<&str>| {
        let options = HazardOptions { kind: wanted.map(String::from), ..options() };
        read_hazard("h.csv", &file(found), &options).map_err(|error| error.to_string())
    };
    assert_eq!(read("mean", None), read("quantile-0.15", Some("quantile-0.15")));
    let refused = read("quantile-0.15", None).unwrap_err();
    assert!(refused.starts_with("found the curves of the kind quantile-0.15; expected the mean, or"), "{refused}");
    let refused = read("mean", Some("quantile-0.84")).unwrap_err();
    assert_eq!(refused, "found the curves of the kind mean; expected quantile-0.84");
}
