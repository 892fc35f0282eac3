//! Lognormal curves → the component library of pelicun, or the fragility model of OpenQuake.

use std::fmt::Write;

use crate::spec::words::Words;
use quick_xml::escape::escape;
use serde_json::json;

use crate::fragility::likelihood::Link;
use crate::fragility::regression::CurveFit;
use crate::intensity::Measure;
use crate::mismatch::Mismatch;
use crate::run::limit::Limit;
use crate::statistics::normal::probability;

/// A program of loss assessment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LossProgram {
    /// The component library of pelicun.
    Pelicun,
    /// The fragility model of OpenQuake.
    OpenQuake,
}

impl Words for LossProgram {
    const WORDS: &'static [(&'static str, LossProgram)] =
        &[("pelicun", LossProgram::Pelicun), ("openquake", LossProgram::OpenQuake)];
}

/// A component with a lognormal curve for each of its limits: its damage states.
#[derive(Clone, Debug, PartialEq)]
pub struct Component {
    id: String,
    /// Measure of records or floors.
    measure: Measure,
    description: String,
    /// The curves, by their medians: the mildest state first.
    states: Vec<State>,
}

#[derive(Clone, Debug, PartialEq)]
struct State {
    limit: Limit,
    /// Median in SI units.
    median: f64,
    beta: f64,
}

/// Curves cross where both have this probability, or one minus it, without a remark (1).
const NEGLIGIBLE: f64 = 1e-4;

impl Component {
    /// Prepares fitted curves, each with its limit. The fits are of `factor` times the measure in SI units, as of
    /// [`MeasureColumn::behind`](crate::intensity::MeasureColumn::behind).
    ///
    /// `id` is the component of pelicun, or the taxonomy of OpenQuake's assets.
    ///
    /// # Errors
    /// A logistic curve, a falling one, two of the same limit, or an identifier that XML or CSV would have to quote or pelicun
    /// would split, as it does at hyphens.
    pub fn new<'f>(
        id: &str,
        measure: Measure,
        factor: f64,
        curves: impl IntoIterator<Item = (Limit, &'f CurveFit)>,
        description: &str,
    ) -> Result<Component, Mismatch> {
        if id.is_empty() || !id.chars().all(|c| c.is_ascii_alphanumeric() || "._".contains(c)) {
            return Err(Mismatch::new(format!("the identifier `{id}`"), "letters, digits, dots and underscores"));
        }
        let mut states: Vec<State> = Vec::new();
        for (limit, fit) in curves {
            let (median, beta) = (fit.median() / factor, fit.dispersion());
            if !(fit.link == Link::Probit && beta > 0.0) {
                let found = format!("a {} curve of dispersion {beta:.4}", fit.link);
                return Err(Mismatch::new(found, "a lognormal one of a dispersion above 0, as of the link probit"));
            }
            if states.iter().any(|state| state.limit == limit) {
                return Err(Mismatch::new(format!("two curves of {limit} for {id}"), "a limit for each"));
            }
            states.push(State { limit, median, beta });
        }
        states.sort_by(|a, b| a.median.total_cmp(&b.median));
        Ok(Component { id: id.into(), measure, description: description.into(), states })
    }

    /// Remarks on neighbouring curves that cross at a probability above 0.0001 and below 0.9999.
    ///
    /// Beyond the crossing the worse state has the greater probability: pelicun, which assigns the worst state exceeded, leaves the
    /// milder one out, and OpenQuake's fractions add up to more than one.
    pub fn crossings(&self) -> Vec<String> {
        let crossing = |pair: &[State]| {
            let [mild, worse] = pair else { return None };
            // Both are Φ(z) where ln m₁ + β₁ z = ln m₂ + β₂ z.
            let z = libm::log(worse.median / mild.median) / (mild.beta - worse.beta);
            let crossed = probability(z);
            let side = if z < 0.0 { "below" } else { "above" };
            let measure = mild.median * libm::exp(mild.beta * z);
            (NEGLIGIBLE..=1.0 - NEGLIGIBLE).contains(&crossed).then(|| {
                format!(
                    "{}: the curves of {} and {} cross at {} = {measure:.3} {}, where both are {:.2} %; {side} it the worse \
                     state has the greater probability",
                    self.id,
                    mild.limit,
                    worse.limit,
                    self.measure,
                    self.measure.unit(),
                    100.0 * crossed
                )
            })
        };
        self.states.windows(2).filter_map(crossing).collect()
    }

    fn unknown(&self, program: &str, known: &str) -> Mismatch {
        Mismatch::new(
            format!("a curve over {}, which {program} does not have", self.measure),
            format!("one over {known}"),
        )
    }
}

/// Returns `fragility.csv` and `fragility.json` of pelicun's component library. Each limit is a limit state of one damage state.
///
/// `gravity` (m/s²) is that of accelerations in g.
///
/// # Errors
/// A measure that pelicun does not have.
pub fn pelicun(components: &[Component], gravity: f64) -> Result<[String; 2], Mismatch> {
    let most = components.iter().map(|component| component.states.len()).max().unwrap_or(0);
    let mut csv = String::from("ID,Incomplete,Demand-Type,Demand-Unit,Demand-Offset,Demand-Directional");
    for number in 1..=most {
        // Writing to a String never fails.
        let _ = write!(csv, ",LS{number}-Family,LS{number}-Theta_0,LS{number}-Theta_1");
    }
    let mut json = json!({
        "_GeneralInformation": {
            "ShortName": "Rocking blocks",
            "Description": "Fragility of rigid blocks that rock, from simulations with rocking-block",
            "Version": env!("CARGO_PKG_VERSION"),
        },
    });
    for component in components {
        let (measure, over_directions) = component.measure.of_component();
        let (demand, unit, factor) = match measure {
            Measure::Pga => ("Peak Ground Acceleration".into(), "g", 1.0 / gravity),
            Measure::Pgv => ("Peak Ground Velocity".into(), "mps", 1.0),
            Measure::Pfa => ("Peak Floor Acceleration".into(), "g", 1.0 / gravity),
            Measure::Pfv => ("Peak Floor Velocity".into(), "mps", 1.0),
            Measure::Sa(period) => (format!("Spectral Acceleration|{period}"), "g", 1.0 / gravity),
            Measure::Sv(period) => (format!("Spectral Velocity|{period}"), "mps", 1.0),
            _ => return Err(component.unknown("pelicun", "PGA, PGV, PFA, PFV, Sa(T) or Sv(T)")),
        };
        // A block in the plane has the demand of its direction, one in space that of the pair.
        let is_directional = u8::from(over_directions.is_none());
        let _ = write!(csv, "\n{},0,{demand},{unit},0,{is_directional}", component.id);
        for State { median, beta, .. } in &component.states {
            let _ = write!(csv, ",lognormal,{},{beta}", median * factor);
        }
        csv += &",,,".repeat(most - component.states.len());
        let numbered = (1..).zip(&component.states);
        let states = numbered.map(|(number, State { limit, .. })| {
            (format!("LS{number}"), json!({ format!("DS{number}"): { "Description": limit.to_string() } }))
        });
        json[&component.id] = json!({
            "Description": "Rigid block that rocks on its foundation",
            "Comments": component.description,
            "SuggestedComponentBlockSize": "1 EA",
            "RoundUpToIntegerQuantity": "True",
            "LimitStates": states.collect::<serde_json::Map<_, _>>(),
        });
    }
    Ok([csv + "\n", format!("{json:#}\n")])
}

/// Returns a fragility model of OpenQuake (NRML 0.5) for contents. Each limit is a limit state.
///
/// The format has mean and standard deviation of the measure itself, in g of `gravity` (m/s²) or cm/s. Below `noDamageLimit`, six
/// dispersions under the least median, OpenQuake takes the probability as zero.
///
/// # Errors
/// A measure that OpenQuake does not have, or components with different limits.
pub fn openquake(components: &[Component], gravity: f64) -> Result<String, Mismatch> {
    let names = |component: &Component| {
        let name = |State { limit, .. }: &State| match limit {
            Limit::Overturned => "overturned".into(),
            Limit::Balance => "balance".into(),
            Limit::Rotation(limit) => format!("rotation_{limit}"),
            Limit::Slip(limit) => format!("slip_{limit}_m"),
            Limit::Plastic(limit) => format!("plastic_{limit}_m"),
            Limit::HalfCycles(limit) => format!("half_cycles_{limit}"),
            Limit::Breaks => "breaks".into(),
            Limit::Tilt(limit) => format!("tilt_{limit}"),
            Limit::Twist(limit) => format!("twist_{limit}_rad"),
            Limit::Drift(limit) => format!("drift_{limit}_m"),
        };
        component.states.iter().map(|state| name(state).replace('.', "_")).collect::<Vec<String>>()
    };
    let states = components.first().map(names).unwrap_or_default();
    let mut functions = String::new();
    for component in components {
        let (imt, factor) = match component.measure.of_component().0 {
            Measure::Pga => ("PGA".into(), 1.0 / gravity),
            Measure::Sa(period) => (format!("SA({period:?})"), 1.0 / gravity),
            Measure::Pgv => ("PGV".into(), 100.0),
            _ => return Err(component.unknown("OpenQuake", "PGA, PGV or Sa(T)")),
        };
        let found = names(component);
        if found != states {
            let found = format!("the limit states {} for {}", found.join(" "), component.id);
            let expected = format!("{} for all components of OpenQuake's model", states.join(" "));
            return Err(Mismatch::new(found, expected));
        }
        let at = |z: f64| component.states.iter().map(move |state| factor * state.median * libm::exp(z * state.beta));
        let (least, greatest) = (at(-6.0).fold(f64::INFINITY, f64::min), at(6.0).fold(0.0, f64::max));
        let _ = writeln!(
            functions,
            r#"    <fragilityFunction id="{}" format="continuous" shape="logncdf">
      <imls imt="{imt}" noDamageLimit="{least:?}" minIML="{least:?}" maxIML="{greatest:?}"/>"#,
            escape(&component.id)
        );
        for (name, State { median, beta, .. }) in states.iter().zip(&component.states) {
            let variance = beta * beta;
            let mean = factor * median * libm::exp(0.5 * variance);
            let deviation = mean * libm::expm1(variance).sqrt();
            let _ = writeln!(functions, r#"      <params ls="{name}" mean="{mean:?}" stddev="{deviation:?}"/>"#);
        }
        functions += "    </fragilityFunction>\n";
    }
    let description = components.iter().map(|component| &*component.description).collect::<Vec<_>>().join("; ");
    Ok(format!(
        r#"<?xml version="1.0" encoding="UTF-8"?>
<nrml xmlns="http://openquake.org/xmlns/nrml/0.5">
  <fragilityModel id="rocking-block" assetCategory="contents" lossCategory="contents">
    <description>{}</description>
    <limitStates>{}</limitStates>
{functions}  </fragilityModel>
</nrml>
"#,
        escape(&description),
        states.join(" ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fragility::{Data, Observation};

    /// A curve of six rows at measures times `scale`.
    fn fit(link: Link, scale: f64) -> CurveFit {
        let rows = [(0.2, false), (0.3, false), (0.4, true), (0.5, false), (0.6, true), (0.9, true)];
        Data::new(rows.map(|(m, over)| Observation::of(&[m * scale], over)).to_vec()).unwrap().fit(link).unwrap()
    }

    fn component(measure: Measure, factor: f64) -> Component {
        let [half, over] = [1.0, 1.5].map(|scale| fit(Link::Probit, scale));
        let curves = [(Limit::Overturned, &over), (Limit::Rotation(0.5), &half)];
        Component::new("block.1", measure, factor, curves, "a < b & c").unwrap()
    }

    #[track_caller]
    fn near(text: &str, exact: f64) {
        assert!((text.parse::<f64>().unwrap() / exact - 1.0).abs() < 1e-14, "{text} {exact}");
    }

    #[test]
    fn medians_are_in_the_units_of_the_programs() {
        let (median, beta) = (fit(Link::Probit, 1.0).median(), fit(Link::Probit, 1.0).dispersion());
        let csv = &pelicun(&[component(Measure::Sa(0.5), 2.0)], 10.0).unwrap()[0];
        let row: Vec<&str> = csv.lines().nth(1).unwrap().split(',').collect();
        assert_eq!(row[..7], ["block.1", "0", "Spectral Acceleration|0.5", "g", "0", "1", "lognormal"]);
        near(row[7], median / 20.0);
        near(row[8], beta);
        near(row[10], fit(Link::Probit, 1.5).median() / 20.0);
        let xml = openquake(&[component(Measure::Pgv, 1.0)], 10.0).unwrap();
        let read = roxmltree::Document::parse(&xml).unwrap();
        let node = |name: &str| {
            read.descendants().find(|node| node.has_tag_name(("http://openquake.org/xmlns/nrml/0.5", name))).unwrap()
        };
        assert_eq!((node("description").text(), node("imls").attribute("imt")), (Some("a < b & c"), Some("PGV")));
        assert_eq!(
            (node("limitStates").text(), node("params").attribute("ls")),
            (Some("rotation_0_5 overturned"), Some("rotation_0_5"))
        );
        let [mean, deviation] =
            ["mean", "stddev"].map(|name| node("params").attribute(name).unwrap().parse::<f64>().unwrap());
        // Moments of the lognormal distribution, inverted.
        let ratio = 1.0 + (deviation / mean).powi(2);
        near(&(mean / ratio.sqrt()).to_string(), 100.0 * median);
        near(&ratio.ln().sqrt().to_string(), beta);
    }

    #[test]
    fn components_with_fewer_states_leave_columns_empty() {
        let over = fit(Link::Probit, 1.0);
        let one = Component::new("b", Measure::Pfv, 1.0, [(Limit::Overturned, &over)], "").unwrap();
        let both = [component(Measure::Pgv, 1.0), one];
        let [csv, json] = pelicun(&both, 9.81).unwrap();
        let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
        assert_eq!(rows.iter().map(Vec::len).collect::<Vec<_>>(), [12, 12, 12]);
        assert_eq!((rows[2][2], &rows[2][9..]), ("Peak Floor Velocity", &[""; 3][..]));
        let json: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!(json["block.1"]["LimitStates"]["LS2"]["DS2"]["Description"], "overturned");
        let refused = openquake(&[component(Measure::Pgv, 1.0), component(Measure::Pfv, 1.0)], 9.81).unwrap_err();
        assert!(refused.to_string().contains("OpenQuake does not have"), "{refused}");
        let over = Component::new("b", Measure::Pgv, 1.0, [(Limit::Overturned, &over)], "").unwrap();
        let refused = openquake(&[both[0].clone(), over], 9.81).unwrap_err().to_string();
        assert!(
            refused.starts_with("found the limit states overturned for b; expected rotation_0_5 overturned"),
            "{refused}"
        );
    }

    /// At a crossing both curves have the probability of the remark.
    #[test]
    fn crossings_are_named_with_their_probability() {
        assert_eq!(component(Measure::Pgv, 1.0).crossings(), [""; 0], "curves of one dispersion never cross");
        let state = |limit, median, beta| State { limit, median, beta };
        let states = vec![state(Limit::Rotation(0.5), 0.5, 0.35), state(Limit::Overturned, 0.6, 0.45)];
        let crossing = Component { states, ..component(Measure::Pgv, 1.0) };
        // ln 0.5 + 0.35 z = ln 0.6 + 0.45 z at z = −1.8232 and 0.26414 m/s; Φ(−1.8232) = 0.03414.
        assert_eq!(
            crossing.crossings(),
            [
                "block.1: the curves of theta/alpha>0.5 and overturned cross at PGV = 0.264 m/s, where both are 3.41 %; below it \
              the worse state has the greater probability"
            ]
        );
    }

    #[test]
    fn curves_that_the_programs_do_not_have_are_refused() {
        let refused = pelicun(&[component(Measure::Cav, 1.0)], 9.81).unwrap_err().to_string();
        assert!(
            refused.starts_with("found a curve over CAV, which pelicun does not have; expected one over PGA"),
            "{refused}"
        );
        let (fit, logit) = (fit(Link::Probit, 1.0), fit(Link::Logit, 1.0));
        let of = |id: &str, fits: &[&CurveFit]| {
            Component::new(id, Measure::Pga, 1.0, fits.iter().map(|&fit| (Limit::Overturned, fit)), "")
        };
        assert!(of("a", &[&logit]).unwrap_err().to_string().starts_with("found a logit curve"));
        let repeated = of("a", &[&fit, &fit]).unwrap_err().to_string();
        assert_eq!(repeated, "found two curves of overturned for a; expected a limit for each");
        for id in ["a b", "a-b", ""] {
            let refused = of(id, &[&fit]).unwrap_err().to_string();
            assert_eq!(refused, format!("found the identifier `{id}`; expected letters, digits, dots and underscores"));
        }
    }
}
