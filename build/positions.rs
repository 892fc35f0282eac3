//! modelDescription.xml with names → the same with positions: value references, the variables that derivatives belong to, and the
//! dependencies of ModelStructure.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use roxmltree::{Document, Node};

use crate::xml::{attribute, child, elements};

/// A replacement of part of a text.
pub type Edit = (Range<usize>, String);

/// The attribute of an unknown that lists the dependencies that only FMI 3.0 has.
pub const FMI3_DEPENDENCIES: &str = "ofFmi3";

/// The attribute of an array that only FMI 3.0 has, of states or their derivatives: the scalars that are its elements in FMI 2.0.
pub const ELEMENTS: &str = "elements";

/// Marks the name of a group in a list of names.
const GROUP: char = '@';

/// The lists of unknowns whose factors are declared. All of them depend on the regime: `dependent`, without more.
const WITH_KINDS: [&str; 2] = ["Outputs", "Derivatives"];

/// Returns the file with positions instead of names, and without the groups. An error names the unknown and the name that is wrong.
pub fn write(text: &str) -> Result<String, String> {
    let document = Document::parse(text).map_err(|e| e.to_string())?;
    let root = document.root_element();
    let of_fmi2 = child(root, "ModelVariables")?;
    let of_fmi3 = child(child(root, "Fmi3")?, "ModelVariables")?;
    let variables: Vec<Node> = elements(of_fmi2).chain(elements(of_fmi3)).collect();
    let mut names = Names { positions: BTreeMap::new(), groups: BTreeMap::new() };
    let mut edits = Vec::new();
    for (position, node) in (1..).zip(&variables) {
        let name = node.attribute_node("name").ok_or_else(|| format!("variable {position} has no name"))?;
        names.positions.insert(name.value(), position);
        // From 1, as positions: some importers take the references of dependencies in FMI 3.0 for positions.
        edits.push((name.range().end..name.range().end, format!(" valueReference=\"{position}\"")));
    }
    for state in variables.iter().flat_map(Node::descendants).filter_map(|node| node.attribute_node("derivative")) {
        edits.push((state.range_value(), names.position(state.value())?.to_string()));
    }
    let dimensions = of_fmi3.descendants().filter(|node| node.has_tag_name("Dimension"));
    for length in dimensions.filter_map(|node| node.attribute_node("valueReference")) {
        edits.push((length.range_value(), names.position(length.value())?.to_string()));
    }
    for elements in elements(of_fmi3).filter_map(|node| node.attribute_node(ELEMENTS)) {
        edits.push((elements.range_value(), words(names.resolve(elements.value())?)));
    }
    let structure = child(root, "ModelStructure")?;
    let groups = child(structure, "Groups")?;
    for group in elements(groups) {
        let name = attribute(group, "name")?;
        let members = names.resolve(attribute(group, "members")?).map_err(|e| format!("group {name}: {e}"))?;
        if names.groups.insert(name, members).is_some() {
            return Err(format!("group {name} stands twice"));
        }
    }
    // Including the indentation of what follows.
    let after = groups.next_sibling_element().ok_or("ModelStructure has nothing but groups")?;
    edits.push((groups.range().start..after.range().start, String::new()));
    for list in elements(structure).filter(|list| *list != groups) {
        for unknown in elements(list) {
            let name = unknown.attribute_node("name").ok_or("an unknown of ModelStructure has no name")?;
            edits.push((name.range(), format!("index=\"{}\"", names.position(name.value())?)));
            for attribute in ["dependencies", FMI3_DEPENDENCIES] {
                let Some(dependencies) = unknown.attribute_node(attribute) else { continue };
                let positions = names.resolve(dependencies.value());
                let positions = positions.map_err(|e| format!("{attribute} of unknown {}: {e}", name.value()))?;
                let kinds = vec!["dependent"; positions.len()].join(" ");
                edits.push((dependencies.range_value(), words(positions)));
                if attribute == "dependencies" && !kinds.is_empty() && WITH_KINDS.contains(&list.tag_name().name()) {
                    let last = unknown.attributes().map(|attribute| attribute.range().end).max().unwrap_or_default();
                    edits.push((last..last, format!(" dependenciesKind=\"{kinds}\"")));
                }
            }
        }
    }
    Ok(apply(text, edits))
}

/// Returns a list of positions.
fn words(positions: BTreeSet<usize>) -> String {
    positions.iter().map(usize::to_string).collect::<Vec<_>>().join(" ")
}

/// Makes the replacements, which do not overlap.
pub fn apply(text: &str, mut edits: Vec<Edit>) -> String {
    edits.sort_by_key(|(range, _)| std::cmp::Reverse(range.start));
    let mut text = text.to_string();
    for (range, replacement) in edits {
        text.replace_range(range, &replacement);
    }
    text
}

/// The names that lists may have.
struct Names<'a> {
    /// The positions of variables, from 1.
    positions: BTreeMap<&'a str, usize>,
    /// The positions of the members of groups.
    groups: BTreeMap<&'a str, BTreeSet<usize>>,
}

impl Names<'_> {
    fn position(&self, name: &str) -> Result<usize, String> {
        self.positions.get(name).copied().ok_or_else(|| format!("{name} is no variable"))
    }

    /// Names of variables and groups → positions in order. A variable that stands twice, by itself or in groups, is refused.
    fn resolve(&self, list: &str) -> Result<BTreeSet<usize>, String> {
        let mut positions = BTreeSet::new();
        for word in list.split_whitespace() {
            let members = match word.strip_prefix(GROUP) {
                None => BTreeSet::from([self.position(word)?]),
                Some(group) => self.groups.get(group).ok_or_else(|| format!("{group} is no group above"))?.clone(),
            };
            if !positions.is_disjoint(&members) {
                return Err(format!("{word} names a variable that is listed already"));
            }
            positions.extend(members);
        }
        Ok(positions)
    }
}
