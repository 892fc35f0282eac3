//! The rewritten copy → test programs → whether a test notices a mutant.

use std::collections::BTreeSet;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

/// Environment of the tests: no shrinking and no storage of failing random cases.
const ENVIRONMENT: [(&str, &str); 2] =
    [("PROPTEST_MAX_SHRINK_ITERS", "0"), ("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "true")];

/// A test that takes this many times the processor time, and more than [`MIN_TIMEOUT`], notices the mutant.
const TIMEOUT: u64 = 10;

/// Least limit on the processor time of a test (s).
const MIN_TIMEOUT: u64 = 5;

/// Number of the signal that ends a test beyond its limit.
const SIGXCPU: i32 = 24;

/// Limit on a test's memory (KiB): a mutant may turn a loop that allocates into an endless one.
const MEMORY: u64 = 8 << 20;

/// An error of the compiler.
pub struct CompileError {
    /// The file in the copy.
    pub file: String,
    /// Places in the file, in bytes, the most important first.
    pub places: Vec<std::ops::Range<usize>>,
    pub code: String,
    pub text: String,
}

/// The tests of one module of a test program, or all tests of a program without modules.
pub struct Program {
    pub name: String,
    path: PathBuf,
    filter: Option<String>,
    folder: PathBuf,
    /// Limit on its processor time (s), if any.
    timeout: Option<u64>,
}

pub enum Verdict {
    Passed,
    Failed,
    TimedOut,
}

/// Returns the errors of compiling the copy, or an empty list.
pub fn check(folder: &Path, out: &Path) -> Result<Vec<CompileError>, String> {
    let mut command = cargo(folder, &out.join("checked"), true)?;
    command.args(["check", "--lib", "--features", "lanes"]);
    let (messages, status) = messages(command)?;
    let errors: Vec<CompileError> = messages.iter().filter_map(|message| error(&message["message"])).collect();
    match status.success() || !errors.is_empty() {
        true => Ok(errors),
        false => Err(format!("cargo check: {status}")),
    }
}

/// Compiles the copy with these tests: `lib`, programs such as `system`, or modules such as `simulation::beyond`.
///
/// Each module inside one counts as a program, so that quick ones run first. Modules in `skip` run only if named themselves. FMUs are
/// packed if the tests include `abi` or `fmi3`, which load them.
pub fn build(folder: &Path, out: &Path, tests: &[String], skip: &[String]) -> Result<Vec<Program>, String> {
    let wanted: BTreeSet<&str> = tests.iter().map(|test| test.split("::").next().unwrap_or(test)).collect();
    let fmus = wanted.contains("abi") || wanted.contains("fmi3");
    let mut command = cargo(folder, &out.join(if fmus { "with-fmus" } else { "without-fmus" }), !fmus)?;
    command.args(["test", "--no-run", "--features", "fmu,lanes", "--package=rocking-block"]);
    for test in &wanted {
        match *test {
            "lib" => command.arg("--lib"),
            "gradients" => command.args(["--package=rocking-gradients", "--test=gradients"]),
            "studies" => command.args(["--package=rocking-studies", "--test=studies"]),
            test => command.args(["--test", test]),
        };
    }
    let (messages, status) = messages(command)?;
    if !status.success() {
        return Err(format!("cargo test: {status}"));
    }
    let mut programs = Vec::new();
    for message in &messages {
        let Some(path) = message["executable"].as_str().filter(|_| message["profile"]["test"] == true) else {
            continue;
        };
        let target = &message["target"];
        let name = if target["kind"][0] == "test" { text(&target["name"]) } else { "lib".into() };
        for module in modules(&name, path)? {
            let full = module.as_ref().map_or(name.clone(), |module| format!("{name}::{module}"));
            let skipped = module.as_ref().is_some_and(|module| skip.contains(module));
            let is_in = |test: &String| full == *test || full.starts_with(&format!("{test}::"));
            if tests.iter().any(|test| is_in(test) && (*test != name || !skipped)) {
                let filter = module.map(|module| format!("{module}::"));
                programs.push(Program { name: full, path: path.into(), filter, folder: folder.into(), timeout: None });
            }
        }
    }
    Ok(programs)
}

/// Returns the modules of a program's tests, none if it has no tests, or one `None` if some are outside of modules or it is the library.
fn modules(name: &str, path: &str) -> Result<BTreeSet<Option<String>>, String> {
    let listed = Command::new(path).args(["--list", "--format=terse"]).output().map_err(|e| format!("{path}: {e}"))?;
    let listed = String::from_utf8_lossy(&listed.stdout).into_owned();
    let modules: Option<BTreeSet<_>> =
        listed.lines().map(|line| line.rsplit_once("::").map(|(module, _)| Some(module.to_string()))).collect();
    Ok(modules.filter(|modules| name != "lib" || modules.is_empty()).unwrap_or_else(|| BTreeSet::from([None])))
}

/// Returns a cargo command in the copy, with its own target folder: the build script depends on whether FMUs are packed.
fn cargo(folder: &Path, target: &Path, inner: bool) -> Result<Command, String> {
    let target = std::path::absolute(target).map_err(|e| format!("{}: {e}", target.display()))?;
    let mut command = Command::new("cargo");
    command.current_dir(folder).env("CARGO_TARGET_DIR", target).env_remove("ROCKING_BLOCK_INNER");
    if inner {
        command.env("ROCKING_BLOCK_INNER", "1");
    }
    Ok(command)
}

/// Returns the messages of cargo.
fn messages(mut command: Command) -> Result<(Vec<Value>, ExitStatus), String> {
    command.args(["--locked", "--message-format=json", "--no-default-features"]).stderr(Stdio::inherit());
    let output = command.output().map_err(|e| format!("cargo does not start: {e}"))?;
    let lines = String::from_utf8_lossy(&output.stdout);
    let messages = lines.lines().map(|line| serde_json::from_str(line).map_err(|e| format!("{line}: {e}")));
    let messages: Vec<Value> = messages.collect::<Result<_, _>>()?;
    Ok((messages, output.status))
}

fn text(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_string()
}

/// Reads an error with its places; returns `None` for one without a place, such as the final count of errors.
fn error(message: &Value) -> Option<CompileError> {
    if message["level"] != "error" {
        return None;
    }
    let mut spans: Vec<&Value> = message["spans"].as_array()?.iter().collect();
    spans.sort_by_key(|span| span["is_primary"] != true);
    let spans: Vec<&Value> = spans.into_iter().map(call).collect();
    let file = text(&spans.first()?["file_name"]);
    let byte = |value: &Value| value.as_u64().unwrap_or_default() as usize;
    let places = spans.iter().filter(|span| span["file_name"] == file.as_str());
    let places = places.map(|span| byte(&span["byte_start"])..byte(&span["byte_end"])).collect();
    Some(CompileError { file, places, code: text(&message["code"]["code"]), text: text(&message["rendered"]) })
}

/// Returns the place at which a macro is called, if a place is inside one.
fn call(span: &Value) -> &Value {
    match &span["expansion"]["span"] {
        Value::Null => span,
        outer => call(outer),
    }
}

impl Program {
    /// Runs the tests without a mutant; they must pass. Their duration sets the time limit with a mutant.
    pub fn measure(&mut self) -> Result<Duration, String> {
        let start = Instant::now();
        match self.run(0)? {
            Verdict::Passed => {}
            Verdict::Failed | Verdict::TimedOut => return Err(format!("{} fails without a mutant", self.name)),
        }
        let time = start.elapsed();
        self.timeout = Some((TIMEOUT * time.as_secs()).max(MIN_TIMEOUT));
        Ok(time)
    }

    /// Runs the tests with a mutant.
    pub fn run(&self, mutant: u32) -> Result<Verdict, String> {
        let time = self.timeout.map_or("unlimited".into(), |limit| limit.to_string());
        let mut command = Command::new("sh");
        command.args([
            "-c",
            &format!("ulimit -v {MEMORY} && ulimit -S -t {time} && exec \"$0\" \"$@\" --test-threads=1 --quiet"),
        ]);
        command.arg(&self.path).args(&self.filter);
        command.envs(ENVIRONMENT).env("MUTANT", mutant.to_string()).current_dir(&self.folder);
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        let status = command.status().map_err(|e| format!("{}: {e}", self.path.display()))?;
        Ok(match status.signal() {
            Some(SIGXCPU) => Verdict::TimedOut,
            Some(_) => Verdict::Failed,
            None if status.success() => Verdict::Passed,
            None => Verdict::Failed,
        })
    }
}
