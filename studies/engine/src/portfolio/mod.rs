//! Several study files with an `[assess]` table each → their objects, ranked by annual rate.
//!
//! Each object is [assessed](crate::assess::assess) as if it were alone; a portfolio compares the results and computes none anew.
//!
//! | module | in → out |
//! | --- | --- |
//! | `studies` | folders and files → plans of one hazard, and the studies that are refused |
//! | `ranking` | the results of all objects → their order |
//! | `work` | plans → results, object by object |

mod ranking;
mod studies;
mod work;

pub use ranking::{FirstState, Help, Matter, Portfolio, RankedObject};
pub use studies::{ObjectStudy, PortfolioError, RefusedStudy, Studies};
pub use work::{Kept, assess_all};
