//! The table of a sweep → probabilities of overturning, or of exceeding a limit.
//!
//! A curve is `P = F(a + b ln IM)` of an intensity measure IM > 0, a surface `F(a + b₁ ln IM₁ + b₂ ln IM₂)` of two. With the
//! normal distribution for F (probit) it is the lognormal fragility curve of median `exp(−a/b)` and dispersion `β = 1/b`; with the
//! logistic one (logit) it is logistic regression. Coefficients maximize the likelihood (J. W. Baker, Efficient analytical
//! fragility function fitting using dynamic structural analysis, Earthquake Spectra 31 (2015) 579–599, without his grouping of
//! levels); intervals and bands are those of the profile likelihood, with rows clustered by motion, or of a bootstrap of whole
//! motions.
//!
//! | module | in → out |
//! | --- | --- |
//! | `table` | the table of a sweep → its columns, by their names |
//! | `cases` | the table of a sweep, a limit → decided rows with their ground motions |
//! | `observation` | the measures and the outcome of a case → an observation |
//! | `separation` | observations → whether a best curve exists |
//! | `data` | observations → data with a unique best curve |
//! | `likelihood` | a linear predictor, an outcome → the log-likelihood and its derivatives |
//! | `regression` | data → the curve of maximum likelihood |
//! | `clusters` | rows that share motions → covariance of the coefficients |
//! | `line` | points that share motions → their least-squares line |
//! | `profile` | a curve → intervals and bands of the profile likelihood |
//! | `bootstrap` | observations of several records → intervals from resampled records |
//! | `quality` | observations, a curve → AUC, Brier score, efficiency, sufficiency |
//! | `goodness` | observations, a curve → the deviance of the curve from groups of rows |
//! | `rows` | rows of a large table in any order → the same rows sorted and counted, on disk |
//! | `nodes` | many rows over a measure → few weighted observations with the same likelihood |
//! | `many` | rows of a large table → their curve or surface with intervals and quality |
//! | `store` | cases with their measures, batch by batch → a list of rows, or sorted rows if they are many |
//! | `assessment` | cases, a measure → its curve with intervals and quality |
//! | `export` | lognormal curves → the files of pelicun and OpenQuake |
//! | `directions` | the table of a sweep in space, a limit → its outcomes by the direction of the ground motion |
//! | `cloud` | rows of a table over a measure → a line through the rotations, and the probability of overturning |
//! | `stripes` | rows at levels of a measure, or their counts → stripes |
//! | `ida` | the table of a sweep over levels → curves of incremental dynamic analysis |
//!
//! ```
//! use rocking_studies::fragility::{Data, Link, Observation};
//!
//! let rows = [(0.2, false), (0.3, false), (0.4, true), (0.5, false), (0.6, true), (0.9, true)];
//! let data = Data::new(rows.map(|(pgv, overturned)| Observation::of(&[pgv], overturned)).to_vec())?;
//! let fit = data.fit(Link::Probit)?;
//! assert!((0.4..0.5).contains(&fit.median()));
//! # Ok::<(), rocking_studies::fragility::CurveFitError>(())
//! ```

mod assessment;
mod bootstrap;
mod cases;
mod cloud;
mod clusters;
mod data;
mod directions;
mod export;
mod goodness;
mod ida;
mod likelihood;
mod line;
mod many;
mod nodes;
mod observation;
mod profile;
mod quality;
mod regression;
mod rows;
mod separation;
mod store;
mod stripes;
mod table;

pub use crate::output::table::split_heading;
pub use crate::run::limit::Limit;
pub use assessment::{Assessment, Surface, Uncertainty, sufficiency_of};
pub use bootstrap::{Bootstrap, bootstrap};
pub use cases::{Case, Motions, RowCounts, RowOutcome, completed};
pub use cloud::{Cloud, CloudColumns, CloudRow, CloudRows, CloudSufficiency, Share, ShareCurve};
pub use clusters::Independence;
pub use data::Data;
pub use directions::Direction;
pub use export::{Component, LossProgram, openquake, pelicun};
pub use goodness::{Goodness, Group};
pub use ida::{Ida, IdaCurve, Response};
pub use likelihood::Link;
pub use line::Line;
pub use observation::{CurveFitError, Observation};
pub use profile::{Interval, LikelihoodProfile};
pub use quality::{auc, brier, efficiency, sufficiency};
pub use regression::CurveFit;
pub use store::{CaseStore, Collected};
pub use stripes::{Stripe, unrolled};
pub use table::{ChosenRows, DESCRIBED, SweepTable, SweepTableError, is_needed};
