//! A lognormal curve → the component library of pelicun, or the fragility model of OpenQuake.

use quick_xml::escape::escape;
use rocking_block::words::Words;
use serde_json::json;

use crate::fragility::likelihood::Link;
use crate::fragility::regression::Fit;
use crate::intensity::Measure;
use crate::run::limit::Limit;

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

/// The reason why a curve cannot be exported.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExportError {
    /// The curve is not lognormal, or falls with the measure.
    #[error(
        "found a {link} curve of dispersion {beta:.4}; expected a lognormal one of a dispersion above 0, as of the link probit"
    )]
    Curve {
        /// The link.
        link: Link,
        /// The dispersion.
        beta: f64,
    },
    /// The program has no such measure.
    #[error("found a curve over {measure}, which {program} does not have; expected one over {known}")]
    Measure {
        /// The measure.
        measure: Measure,
        /// The program.
        program: &'static str,
        /// Its measures.
        known: &'static str,
    },
    /// The identifier has other characters.
    #[error("found the identifier `{0}`; expected letters, digits, dots, hyphens and underscores")]
    Id(String),
}

/// A lognormal fragility curve for other programs.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportedCurve {
    id: String,
    measure: Measure,
    median: f64,
    beta: f64,
    limit: Limit,
    description: String,
    gravity: f64,
}

impl ExportedCurve {
    /// Prepares a fitted curve of a measure of records; the fit is one of `factor` times the measure, in SI units.
    ///
    /// `id` is the component, or the taxonomy of the assets; `gravity` (m/s²) is that of accelerations in g.
    ///
    /// # Errors
    /// A logistic curve, a falling one, or an identifier that XML and CSV would have to quote.
    pub fn new(
        id: &str,
        measure: Measure,
        factor: f64,
        fit: &Fit,
        limit: Limit,
        description: &str,
        gravity: f64,
    ) -> Result<ExportedCurve, ExportError> {
        let (median, beta) = (fit.median() / factor, fit.dispersion());
        if !(fit.link == Link::Probit && beta > 0.0) {
            return Err(ExportError::Curve { link: fit.link, beta });
        }
        if id.is_empty() || !id.chars().all(|c| c.is_ascii_alphanumeric() || "._-".contains(c)) {
            return Err(ExportError::Id(id.into()));
        }
        Ok(ExportedCurve { id: id.into(), measure, median, beta, limit, description: description.into(), gravity })
    }

    fn unknown(&self, program: &'static str, known: &'static str) -> ExportError {
        ExportError::Measure { measure: self.measure, program, known }
    }

    /// Returns `fragility.csv` and `fragility.json` of pelicun's component library, with a limit state of one damage state.
    ///
    /// # Errors
    /// [`ExportError::Measure`].
    pub fn pelicun(&self) -> Result<[String; 2], ExportError> {
        let (demand, unit, factor) = match self.measure {
            Measure::Pga => ("Peak Ground Acceleration".into(), "g", 1.0 / self.gravity),
            Measure::Pgv => ("Peak Ground Velocity".into(), "mps", 1.0),
            Measure::Sa(period) => (format!("Spectral Acceleration|{period}"), "g", 1.0 / self.gravity),
            Measure::Sv(period) => (format!("Spectral Velocity|{period}"), "mps", 1.0),
            _ => return Err(self.unknown("pelicun", "PGA, PGV, Sa(T) or Sv(T)")),
        };
        let ExportedCurve { id, median, beta, limit, description, .. } = self;
        // A block rocks in one plane: the demand is that of the component's direction.
        let csv = format!(
            "ID,Incomplete,Demand-Type,Demand-Unit,Demand-Offset,Demand-Directional,LS1-Family,LS1-Theta_0,LS1-Theta_1\n\
             {id},0,{demand},{unit},0,1,lognormal,{},{beta}\n",
            median * factor
        );
        let json = json!({
            "_GeneralInformation": {
                "ShortName": "Rocking blocks",
                "Description": "Fragility of rigid blocks that rock, from simulations with rocking-block",
                "Version": env!("CARGO_PKG_VERSION"),
            },
            id: {
                "Description": "Rigid block that rocks on its foundation",
                "Comments": description,
                "SuggestedComponentBlockSize": "1 EA",
                "RoundUpToIntegerQuantity": "True",
                "LimitStates": { "LS1": { "DS1": { "Description": limit.to_string() } } },
            },
        });
        Ok([csv, format!("{json:#}\n")])
    }

    /// Returns a fragility model of OpenQuake in NRML 0.5, of contents with one limit state.
    ///
    /// The format has mean and standard deviation of the measure itself, in g or cm/s. Below `noDamageLimit`, six dispersions under
    /// the median, OpenQuake takes the probability as zero.
    ///
    /// # Errors
    /// [`ExportError::Measure`].
    pub fn openquake(&self) -> Result<String, ExportError> {
        let (imt, factor) = match self.measure {
            Measure::Pga => ("PGA".into(), 1.0 / self.gravity),
            Measure::Sa(period) => (format!("SA({period:?})"), 1.0 / self.gravity),
            Measure::Pgv => ("PGV".into(), 100.0),
            _ => return Err(self.unknown("OpenQuake", "PGA, PGV or Sa(T)")),
        };
        let (median, variance) = (self.median * factor, self.beta * self.beta);
        let mean = median * libm::exp(0.5 * variance);
        let deviation = mean * libm::expm1(variance).sqrt();
        let [least, greatest] = [-6.0, 6.0].map(|z| median * libm::exp(z * self.beta));
        let state = match self.limit {
            Limit::Overturned => "overturned".into(),
            Limit::Rotation(limit) => format!("rotation_{limit}").replace('.', "_"),
            Limit::Slip(limit) => format!("slip_{limit}_m").replace('.', "_"),
        };
        let (id, description) = (escape(&self.id), escape(&self.description));
        Ok(format!(
            r#"<?xml version="1.0" encoding="UTF-8"?>
<nrml xmlns="http://openquake.org/xmlns/nrml/0.5">
  <fragilityModel id="rocking-block" assetCategory="contents" lossCategory="contents">
    <description>{description}</description>
    <limitStates>{state}</limitStates>
    <fragilityFunction id="{id}" format="continuous" shape="logncdf">
      <imls imt="{imt}" noDamageLimit="{least:?}" minIML="{least:?}" maxIML="{greatest:?}"/>
      <params ls="{state}" mean="{mean:?}" stddev="{deviation:?}"/>
    </fragilityFunction>
  </fragilityModel>
</nrml>
"#
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fragility::{Data, Observation};

    fn fit(link: Link) -> Fit {
        let rows = [(0.2, false), (0.3, false), (0.4, true), (0.5, false), (0.6, true), (0.9, true)];
        Data::new(rows.map(|(m, over)| Observation::of(&[m], over)).to_vec()).unwrap().fit(link).unwrap()
    }

    fn curve(measure: Measure, factor: f64) -> ExportedCurve {
        ExportedCurve::new("block.1", measure, factor, &fit(Link::Probit), Limit::Rotation(0.5), "a < b & c", 10.0)
            .unwrap()
    }

    #[test]
    fn medians_are_in_the_units_of_the_programs() {
        let (median, beta) = (fit(Link::Probit).median(), fit(Link::Probit).dispersion());
        let csv = &curve(Measure::Sa(0.5), 2.0).pelicun().unwrap()[0];
        let row: Vec<&str> = csv.lines().nth(1).unwrap().split(',').collect();
        assert_eq!(row[..7], ["block.1", "0", "Spectral Acceleration|0.5", "g", "0", "1", "lognormal"]);
        let near = |text: &str, exact: f64| {
            assert!((text.parse::<f64>().unwrap() / exact - 1.0).abs() < 1e-14, "{text} {exact}")
        };
        near(row[7], median / 20.0);
        near(row[8], beta);
        let xml = curve(Measure::Pgv, 1.0).openquake().unwrap();
        let read = roxmltree::Document::parse(&xml).unwrap();
        let node = |name: &str| {
            read.descendants().find(|node| node.has_tag_name(("http://openquake.org/xmlns/nrml/0.5", name))).unwrap()
        };
        assert_eq!((node("description").text(), node("imls").attribute("imt")), (Some("a < b & c"), Some("PGV")));
        assert_eq!(
            (node("limitStates").text(), node("params").attribute("ls")),
            (Some("rotation_0_5"), Some("rotation_0_5"))
        );
        let [mean, deviation] =
            ["mean", "stddev"].map(|name| node("params").attribute(name).unwrap().parse::<f64>().unwrap());
        // Moments of the lognormal distribution, inverted.
        let ratio = 1.0 + (deviation / mean).powi(2);
        near(&(mean / ratio.sqrt()).to_string(), 100.0 * median);
        near(&ratio.ln().sqrt().to_string(), beta);
    }

    #[test]
    fn curves_that_the_programs_do_not_have_are_refused() {
        let refused = curve(Measure::Cav, 1.0).pelicun().unwrap_err().to_string();
        assert!(
            refused.starts_with("found a curve over CAV, which pelicun does not have; expected one over PGA"),
            "{refused}"
        );
        assert!(curve(Measure::Sv(1.0), 1.0).openquake().unwrap_err().to_string().contains("OpenQuake does not have"));
        let of = |id: &str, link| ExportedCurve::new(id, Measure::Pga, 1.0, &fit(link), Limit::Overturned, "", 9.81);
        assert!(of("a", Link::Logit).unwrap_err().to_string().starts_with("found a logit curve"));
        assert_eq!(of("a b", Link::Probit), Err(ExportError::Id("a b".into())));
    }
}
