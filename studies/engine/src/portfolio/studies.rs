//! Folders and files → plans of one hazard, and the studies that are refused.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::assess::{Hazard, Plan};

/// The reason why studies are no portfolio.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct PortfolioError(String);

/// A study of a portfolio.
#[derive(Clone, Debug)]
pub struct ObjectStudy {
    /// Name of its results: that of the study file without its ending.
    pub name: String,
    /// The study file.
    pub file: PathBuf,
    /// The assessment.
    pub plan: Plan,
}

impl ObjectStudy {
    /// The folder to which the paths of the study are relative.
    pub fn folder(&self) -> &Path {
        self.file.parent().unwrap_or(Path::new(""))
    }
}

/// A study that is not assessed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RefusedStudy {
    /// The study file.
    pub study: String,
    /// The error, with the file and its line where it has one.
    pub reason: String,
}

/// The studies of a portfolio.
#[derive(Clone, Debug)]
pub struct Studies {
    /// Those that are ready to run. They have one hazard.
    pub valid: Vec<ObjectStudy>,
    /// Those with an error.
    pub refused: Vec<RefusedStudy>,
}

impl Studies {
    /// Reads study files, and all `*.toml` in folders, sorted by name. A study with an error is refused, and the others remain.
    ///
    /// # Errors
    /// No study, or none without an error; two objects of one name; hazards, or years of the probabilities, that differ.
    pub fn read(paths: &[PathBuf]) -> Result<Studies, PortfolioError> {
        let mut files = Vec::new();
        for path in paths {
            files.extend(if path.is_dir() { of_folder(path)? } else { vec![path.clone()] });
        }
        check_distinct_names(&files)?;
        let (mut valid, mut refused) = (Vec::new(), Vec::new());
        for file in files {
            match read(&file) {
                Ok(study) => valid.push(study),
                Err(reason) => refused.push(RefusedStudy { study: file.display().to_string(), reason }),
            }
        }
        if valid.is_empty() {
            let reasons: Vec<&str> = refused.iter().map(|refused| refused.reason.as_str()).collect();
            return Err(PortfolioError(format!("no study can be assessed: {}", reasons.join("; "))));
        }
        check_titles(&valid)?;
        check_hazards(&valid)?;
        check_years(&valid)?;
        Ok(Studies { valid, refused })
    }
}

/// The study files of a folder, sorted.
fn of_folder(folder: &Path) -> Result<Vec<PathBuf>, PortfolioError> {
    let unreadable = |error: std::io::Error| PortfolioError(format!("{}: cannot be read: {error}", folder.display()));
    let entries = std::fs::read_dir(folder).and_then(Iterator::collect::<Result<Vec<_>, _>>).map_err(unreadable)?;
    let mut files: Vec<PathBuf> = entries.into_iter().map(|entry| entry.path()).collect();
    files.retain(|file| file.extension().is_some_and(|ending| ending == "toml") && !file.is_dir());
    files.sort();
    if files.is_empty() {
        let expected = "expected a study file *.toml with [assess] for each object";
        return Err(PortfolioError(format!("{}: the folder has no *.toml; {expected}", folder.display())));
    }
    Ok(files)
}

fn name(file: &Path) -> String {
    file.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// Refuses files of one name: their results would be in one folder. Some file systems do not tell upper from lower case.
fn check_distinct_names(files: &[PathBuf]) -> Result<(), PortfolioError> {
    let mut known: HashMap<String, &Path> = HashMap::new();
    for file in files {
        if let Some(other) = known.insert(name(file).to_lowercase(), file) {
            return Err(PortfolioError(format!(
                "{} and {} have one name; expected another name for each study file, which names its results",
                other.display(),
                file.display()
            )));
        }
    }
    Ok(())
}

fn read(file: &Path) -> Result<ObjectStudy, String> {
    let text = std::fs::read_to_string(file).map_err(|error| format!("{}: cannot be read: {error}", file.display()))?;
    let short = file.file_name().unwrap_or_default().to_string_lossy();
    let plan = Plan::read(&short, &text, file.parent().unwrap_or(Path::new("")));
    let plan = plan.map_err(|error| format!("{}:{}: {}", file.display(), error.line, error.message))?;
    Ok(ObjectStudy { name: name(file), file: file.into(), plan })
}

/// The first two studies that disagree, with a description of each.
fn disagreement(
    studies: &[ObjectStudy],
    agree: impl Fn(&Plan, &Plan) -> bool,
    describe: impl Fn(&Plan) -> Option<String>,
) -> Option<String> {
    let mut described = studies.iter().filter_map(|study| Some((study, describe(&study.plan)?)));
    let (first, words) = described.next()?;
    let (other, others) = described.find(|(study, _)| !agree(&first.plan, &study.plan))?;
    Some(format!("{} has {words} and {} {others}", first.file.display(), other.file.display()))
}

fn refused(found: Option<String>, what: &str, expected: &str) -> Result<(), PortfolioError> {
    found.map_or(Ok(()), |found| Err(PortfolioError(format!("{what}: {found}; expected {expected}"))))
}

fn check_titles(studies: &[ObjectStudy]) -> Result<(), PortfolioError> {
    for (number, study) in studies.iter().enumerate() {
        let mut before = studies[..number].iter();
        if let Some(other) = before.find(|other| other.plan.title.trim() == study.plan.title.trim()) {
            return Err(PortfolioError(format!(
                "two objects have the title \"{}\": {} and {}; expected another title for each",
                study.plan.title,
                other.file.display(),
                study.file.display()
            )));
        }
    }
    Ok(())
}

/// Refuses two hazards: rates of two sites, or of two models of one site, have no order. Studies without a hazard have no rate.
fn check_hazards(studies: &[ObjectStudy]) -> Result<(), PortfolioError> {
    let file = |plan: &Plan, hazard: &Hazard| {
        let input = plan.inputs.iter().find(|input| input.file == hazard.file);
        (input.map(|input| input.sha256.clone()), hazard.options.site.clone(), hazard.options.kind.clone())
    };
    let agree = |one: &Plan, other: &Plan| match (&one.hazard, &other.hazard) {
        (Some(a), Some(b)) if one.measure == other.measure => {
            (a.curve.levels(), a.curve.rates()) == (b.curve.levels(), b.curve.rates())
        }
        // Other measures of one file, such as an export with all of them.
        (Some(a), Some(b)) => file(one, a) == file(other, b) && a.options.years == b.options.years,
        _ => true,
    };
    let describe = |plan: &Plan| {
        let hazard = plan.hazard.as_ref()?;
        let site = hazard.options.site.as_ref().map(|site| format!(", site {site}")).unwrap_or_default();
        Some(format!("{}{site} ({} levels of {})", hazard.file, hazard.curve.levels().len(), plan.measure))
    };
    let expected = "one hazard for all objects; a portfolio for each site ranks those of the site";
    refused(disagreement(studies, agree, describe), "the hazards differ", expected)
}

/// Refuses probabilities in different numbers of years.
fn check_years(studies: &[ObjectStudy]) -> Result<(), PortfolioError> {
    let found = disagreement(studies, |one, other| one.years == other.years, |plan| Some(format!("{}", plan.years)));
    refused(found, "the years of the probabilities differ", "the same `years` in each [assess]")
}
