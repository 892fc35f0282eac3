//! Sources and mutants → a copy of the sources in which each mutant has a switch.

use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::Command;

use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{BinOp, Expr, Pat, PatGuard};

use crate::list::{self, Genre, Mutant};
use crate::outcomes::Outcome;
use crate::tests::CompileError;

/// The module with the switch, added to the copy. It is set before any code of the program or library runs, so that reading it
/// costs a load and a comparison.
const SWITCH: &str = r#"
mod mutation {
    use std::sync::atomic::{AtomicU32, Ordering};

    static MUTANT: AtomicU32 = AtomicU32::new(0);

    #[inline(always)]
    pub fn active(mutant: u32) -> bool {
        MUTANT.load(Ordering::Relaxed) == mutant
    }

    #[used]
    #[unsafe(link_section = ".init_array")]
    static SET: extern "C" fn() = set;

    extern "C" fn set() {
        let mutant = std::env::var("MUTANT").ok().and_then(|number| number.parse().ok());
        MUTANT.store(mutant.unwrap_or(0), Ordering::Relaxed);
    }
}
"#;

/// The file to which the switch is added.
const LIBRARY: &str = "src/lib.rs";

/// The attribute of an inlined function, and the attribute of the same length that replaces it.
const INLINED: &str = "#[inline(always)]";
const CALLED: &str = "#[inline(never)] ";

/// The copy is optimized like a release and checked like the development profile.
const CONFIG: &str = r#"[profile.dev.package]
rocking-block = { opt-level = 3 }
rocking-gradients = { opt-level = 3 }
libm = { opt-level = 3 }
nalgebra = { opt-level = 3 }
"#;

/// A copy of the sources.
pub struct Copy {
    pub folder: PathBuf,
}

/// A part of a rewritten file, and the mutants that a compiler error inside it rules out.
pub struct Region {
    place: Range<usize>,
    mutants: Vec<u32>,
    /// True for the text of a mutant, false for an expression or body with switches.
    mutated: bool,
}

/// Result of rewriting a file.
pub struct Rewritten {
    pub regions: Vec<Region>,
    pub refused: Vec<(u32, Outcome)>,
}

impl Copy {
    /// Copies all files that git tracks or would add, except those to be rewritten.
    pub fn of_sources(folder: &Path, rewritten: impl Fn(&str) -> bool) -> Result<Copy, String> {
        let listed = Command::new("git").args(["ls-files", "-co", "--exclude-standard", "-z"]).output();
        let listed = listed.map_err(|e| format!("git does not start: {e}"))?;
        let copy = Copy { folder: folder.to_path_buf() };
        for file in String::from_utf8_lossy(&listed.stdout).split('\0').filter(|file| Path::new(file).is_file()) {
            if file == LIBRARY || rewritten(file) {
                continue;
            }
            copy.write(file, &std::fs::read(file).map_err(|e| format!("{file}: {e}"))?)?;
        }
        copy.write(".cargo/config.toml", CONFIG.as_bytes())?;
        let library = std::fs::read_to_string(LIBRARY).map_err(|e| format!("{LIBRARY}: {e}"))?;
        copy.write(LIBRARY, (library + SWITCH).as_bytes())?;
        Ok(copy)
    }

    /// Writes a file unless its content is unchanged, so that nothing is compiled again without need.
    fn write(&self, file: &str, content: &[u8]) -> Result<(), String> {
        let path = self.folder.join(file);
        if std::fs::read(&path).is_ok_and(|old| old == content) {
            return Ok(());
        }
        let written =
            path.parent().map_or(Ok(()), std::fs::create_dir_all).and_then(|()| std::fs::write(&path, content));
        written.map_err(|e| format!("{}: {e}", path.display()))
    }

    /// Writes a file with switches for these mutants, all from this file.
    pub fn rewrite(&self, file: &str, mutants: &[&Mutant]) -> Result<Rewritten, String> {
        let source = std::fs::read_to_string(file).map_err(|e| format!("{file}: {e}"))?;
        // A function inlined into each stage of each law would be compiled with its switches hundreds of times.
        let source = source.replace(INLINED, CALLED);
        let (text, rewritten) = rewrite(&source, mutants).map_err(|e| format!("{file}: {e}"))?;
        self.write(file, text.as_bytes())?;
        Ok(rewritten)
    }
}

/// Returns the mutants that a compiler error rules out: the one whose text contains it, or all of the smallest switched part
/// around it.
pub fn culprits(regions: &BTreeMap<&str, Vec<Region>>, error: &CompileError) -> Result<Vec<(u32, Outcome)>, String> {
    // The compiler's error for a function call in a constant.
    const NOT_CONST: &str = "E0015";
    let none = || format!("the copy does not compile, and no mutant is to blame:\n{}", error.text);
    let regions = regions.get(error.file.as_str()).ok_or_else(none)?;
    let around = |place: &Range<usize>, mutated: bool| {
        let around = regions.iter().filter(|region| region.mutated == mutated);
        let around = around.filter(|r| r.place.start <= place.start && place.end <= r.place.end);
        around.min_by_key(|region| region.place.len())
    };
    let found = error.places.iter().find_map(|place| around(place, true));
    let found = found.or_else(|| error.places.iter().find_map(|place| around(place, false)));
    let Region { mutants, mutated, .. } = found.ok_or_else(none)?;
    let outcome = if *mutated && error.code != NOT_CONST { Outcome::DoesNotCompile } else { Outcome::NotRun };
    Ok(mutants.iter().map(|&mutant| (mutant, outcome.clone())).collect())
}

/// The form of the switches at a place.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    /// A function's body, preceded by an early return of the mutant's value.
    Body,
    /// The guard of an arm, which the switch may bypass.
    Guard,
    /// The end of an arm's pattern, where an added guard keeps it from matching.
    Arm,
    /// An expression that becomes one branch of an `if`.
    Expression,
}

/// The place that gets the switch of a mutant.
#[derive(Clone)]
enum Site {
    Switched(Kind, Range<usize>),
    /// No switch is possible here.
    Refused(Outcome),
}

/// Start of a mutant (in bytes) and its genre → the place of its switch.
#[derive(Default)]
struct Sites {
    found: BTreeMap<(usize, Genre), Site>,
    constant: bool,
}

impl Sites {
    fn insert(&mut self, start: usize, genre: Genre, site: Site) {
        let site = if self.constant { Site::Refused(Outcome::NotRun) } else { site };
        self.found.insert((start, genre), site);
    }

    fn function(&mut self, block: &syn::Block, constant: bool, inside: impl FnOnce(&mut Sites)) {
        self.within(constant, |sites| {
            if let (Some(first), Some(last)) = (block.stmts.first(), block.stmts.last()) {
                let body = bytes(first).start..bytes(last).end;
                sites.insert(body.start, Genre::FnValue, Site::Switched(Kind::Body, body));
            }
            inside(sites);
        });
    }

    fn within(&mut self, constant: bool, inside: impl FnOnce(&mut Sites)) {
        let before = self.constant;
        self.constant |= constant;
        inside(self);
        self.constant = before;
    }
}

/// Operators of similar precedence: replacing one by another of its class changes nothing outside the outermost of them.
#[derive(PartialEq, Eq)]
enum Class {
    Arithmetic,
    Logic,
    Single,
}

fn class(op: &BinOp) -> Class {
    use BinOp::*;
    match op {
        And(_) | Or(_) => Class::Logic,
        Add(_) | Sub(_) | Mul(_) | Div(_) | Rem(_) | BitXor(_) | BitAnd(_) | BitOr(_) | Shl(_) | Shr(_) => {
            Class::Arithmetic
        }
        _ => Class::Single,
    }
}

/// Returns true if a condition binds names, which an expression next to it could not use.
fn binds(expression: &Expr) -> bool {
    match expression {
        Expr::Let(_) => true,
        Expr::Binary(binary) if class(&binary.op) == Class::Logic => binds(&binary.left) || binds(&binary.right),
        _ => false,
    }
}

fn bytes(part: &impl Spanned) -> Range<usize> {
    part.span().byte_range()
}

impl<'ast> Visit<'ast> for Sites {
    fn visit_item_fn(&mut self, i: &'ast syn::ItemFn) {
        self.function(&i.block, i.sig.constness.is_some(), |sites| visit::visit_item_fn(sites, i));
    }

    fn visit_impl_item_fn(&mut self, i: &'ast syn::ImplItemFn) {
        self.function(&i.block, i.sig.constness.is_some(), |sites| visit::visit_impl_item_fn(sites, i));
    }

    fn visit_trait_item_fn(&mut self, i: &'ast syn::TraitItemFn) {
        match &i.default {
            Some(block) => self.function(block, false, |sites| visit::visit_trait_item_fn(sites, i)),
            None => visit::visit_trait_item_fn(self, i),
        }
    }

    fn visit_item_const(&mut self, i: &'ast syn::ItemConst) {
        self.within(true, |sites| visit::visit_item_const(sites, i));
    }

    fn visit_impl_item_const(&mut self, i: &'ast syn::ImplItemConst) {
        self.within(true, |sites| visit::visit_impl_item_const(sites, i));
    }

    fn visit_trait_item_const(&mut self, i: &'ast syn::TraitItemConst) {
        self.within(true, |sites| visit::visit_trait_item_const(sites, i));
    }

    fn visit_item_static(&mut self, i: &'ast syn::ItemStatic) {
        self.within(true, |sites| visit::visit_item_static(sites, i));
    }

    fn visit_type_array(&mut self, i: &'ast syn::TypeArray) {
        self.within(true, |sites| visit::visit_type_array(sites, i));
    }

    fn visit_expr_repeat(&mut self, i: &'ast syn::ExprRepeat) {
        self.visit_expr(&i.expr);
        self.within(true, |sites| sites.visit_expr(&i.len));
    }

    fn visit_expr_binary(&mut self, i: &'ast syn::ExprBinary) {
        let start = bytes(&i.op).start;
        // An outer operator of the same class has already chosen the switched expression.
        let whole = self.found.get(&(start, Genre::BinaryOperator)).cloned().unwrap_or_else(|| {
            let binds = class(&i.op) == Class::Logic && (binds(&i.left) || binds(&i.right));
            match binds {
                true => Site::Refused(Outcome::DoesNotCompile),
                false => Site::Switched(Kind::Expression, bytes(i)),
            }
        });
        for operand in [&i.left, &i.right] {
            if let Expr::Binary(inner) = &**operand
                && class(&i.op) != Class::Single
                && class(&inner.op) == class(&i.op)
            {
                self.insert(bytes(&inner.op).start, Genre::BinaryOperator, whole.clone());
            }
        }
        self.insert(start, Genre::BinaryOperator, whole);
        visit::visit_expr_binary(self, i);
    }

    fn visit_expr_unary(&mut self, i: &'ast syn::ExprUnary) {
        self.insert(bytes(&i.op).start, Genre::UnaryOperator, Site::Switched(Kind::Expression, bytes(i)));
        visit::visit_expr_unary(self, i);
    }

    fn visit_expr_match(&mut self, i: &'ast syn::ExprMatch) {
        visit::visit_expr_match(self, i);
        // cargo-mutants also deletes arms next to a wildcard with a guard, which leaves values unmatched.
        if !i.arms.iter().any(|arm| matches!(arm.pat, Pat::Wild(_))) {
            for arm in &i.arms {
                self.insert(bytes(arm).start, Genre::MatchArm, Site::Refused(Outcome::DoesNotCompile));
            }
        }
    }

    fn visit_arm(&mut self, i: &'ast syn::Arm) {
        let (pattern, guard) = match &i.pat {
            Pat::Guard(PatGuard { pat, guard, .. }) => (pat.as_ref(), Some(guard)),
            pattern => (pattern, None),
        };
        let end = bytes(pattern).end;
        self.insert(bytes(i).start, Genre::MatchArm, Site::Switched(Kind::Arm, end..end));
        if let Some(guard) = guard {
            self.insert(bytes(guard).start, Genre::MatchArmGuard, Site::Switched(Kind::Guard, bytes(guard)));
        }
        visit::visit_arm(self, i);
    }

    fn visit_expr_struct(&mut self, i: &'ast syn::ExprStruct) {
        for field in &i.fields {
            self.insert(bytes(field).start, Genre::StructField, Site::Switched(Kind::Expression, bytes(i)));
        }
        visit::visit_expr_struct(self, i);
    }
}

/// The text of a mutant, an alternative to the original.
struct Alternative {
    mutant: u32,
    text: String,
}

/// A place with switches. Places are sorted from front to back, an outer one before those inside it.
type Place = (usize, Reverse<usize>, Kind);

/// Rewrites a file with switches.
fn rewrite(source: &str, mutants: &[&Mutant]) -> Result<(String, Rewritten), String> {
    let file = syn::parse_file(source).map_err(|e| e.to_string())?;
    let mut sites = Sites::default();
    sites.visit_file(&file);
    let starts: Vec<usize> = std::iter::once(0).chain(source.match_indices('\n').map(|(end, _)| end + 1)).collect();
    let offset = |at: list::Place| -> Option<usize> {
        let line = *starts.get(at.line.checked_sub(1)?)?;
        let mut characters = source[line..].char_indices().map(|(offset, _)| line + offset).chain([source.len()]);
        characters.nth(at.column.checked_sub(1)?)
    };
    let mut places: BTreeMap<Place, Vec<Alternative>> = BTreeMap::new();
    let mut refused = Vec::new();
    for mutant in mutants {
        let span = (offset(mutant.span.start), offset(mutant.span.end));
        let (Some(start), Some(end)) = span else { return Err(format!("{}: no such place", mutant.place())) };
        let site = sites.found.get(&(start, mutant.genre)).cloned();
        let (kind, place) = match site.ok_or_else(|| format!("{}: {}: not found", mutant.place(), mutant.change))? {
            Site::Switched(kind, place) => (kind, place),
            Site::Refused(outcome) => {
                refused.push((mutant.number, outcome));
                continue;
            }
        };
        let mut text = mutant.replacement.clone();
        if kind == Kind::Expression {
            text = format!("{} {text} {}", &source[place.start..start], &source[end..place.end]);
            if syn::parse_str::<Expr>(&text).is_err() {
                refused.push((mutant.number, Outcome::DoesNotCompile));
                continue;
            }
        }
        let key = (place.start, Reverse(place.end), kind);
        places.entry(key).or_default().push(Alternative { mutant: mutant.number, text });
    }
    let places: Vec<_> = places.into_iter().collect();
    let mut writer = Writer { source, text: String::new(), regions: Vec::new() };
    writer.render(0..source.len(), &places);
    Ok((writer.text, Rewritten { regions: writer.regions, refused }))
}

struct Writer<'s> {
    source: &'s str,
    text: String,
    regions: Vec<Region>,
}

impl Writer<'_> {
    /// Writes a part of the source with its switches.
    fn render(&mut self, part: Range<usize>, places: &[(Place, Vec<Alternative>)]) {
        let (mut at, mut left) = (part.start, places);
        while let Some(((place, alternatives), after)) = left.split_first() {
            let (start, end, kind) = (place.0, place.1.0, place.2);
            let inside = after.iter().take_while(|((start, ..), _)| *start < end).count();
            self.text += &self.source[at..start];
            let begun = self.text.len();
            self.switch(kind, start..end, alternatives, &after[..inside]);
            let mutants = alternatives.iter().map(|alternative| alternative.mutant).collect();
            self.regions.push(Region { place: begun..self.text.len(), mutants, mutated: false });
            (at, left) = (end, &after[inside..]);
        }
        self.text += &self.source[at..part.end];
    }

    fn switch(
        &mut self,
        kind: Kind,
        place: Range<usize>,
        alternatives: &[Alternative],
        inside: &[(Place, Vec<Alternative>)],
    ) {
        let active = |mutant: u32| format!("crate::mutation::active({mutant})");
        let inactive: Vec<String> = alternatives.iter().map(|a| format!("!{}", active(a.mutant))).collect();
        let inactive = inactive.join(" && ");
        match kind {
            Kind::Body => {
                for alternative in alternatives {
                    self.text += &format!("if {} {{ return ", active(alternative.mutant));
                    self.mutated(alternative);
                    self.text += "; } ";
                }
                self.render(place, inside);
            }
            Kind::Guard => {
                let passed = alternatives.iter().filter(|alternative| alternative.text == "true");
                let passed: String = passed.map(|alternative| format!(" || {}", active(alternative.mutant))).collect();
                self.text += &format!("(({inactive}) && (");
                self.render(place, inside);
                self.text += &format!("){passed})");
            }
            Kind::Arm => self.text += &format!(" if {inactive}"),
            Kind::Expression => {
                // The original comes first, so that the compiler reports type errors in the alternatives.
                self.text += &format!("(if {inactive} {{ ");
                self.render(place, inside);
                for (i, alternative) in alternatives.iter().enumerate() {
                    let last = i + 1 == alternatives.len();
                    let otherwise = if last { String::new() } else { format!("if {} ", active(alternative.mutant)) };
                    self.text += &format!(" }} else {otherwise}{{ ");
                    self.mutated(alternative);
                }
                self.text += " })";
            }
        }
    }

    fn mutated(&mut self, alternative: &Alternative) {
        let begun = self.text.len();
        self.text += &alternative.text;
        let mutants = vec![alternative.mutant];
        self.regions.push(Region { place: begun..self.text.len(), mutants, mutated: true });
    }
}
