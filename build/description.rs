//! modelDescription.xml → a checked list of variables → Rust.

use std::collections::BTreeSet;
use std::fmt::Write;

use roxmltree::{Document, Node};

use crate::fmi3::{self, Fmi3};
use crate::positions::{self, apply};
use crate::xml::{attribute, child, elements};

/// The parts of modelDescription.xml that the build uses.
pub struct Description {
    pub guid: String,
    pub variables: Vec<Variable>,
    /// modelDescription.xml of FMI 2.0, with its GUID. It has Integers instead of enumerations, and lacks the parts that only FMI 3.0 has.
    pub packed: String,
    /// modelDescription.xml of FMI 3.0.
    pub fmi3: Fmi3,
    /// terminalsAndIcons.xml.
    pub terminals: String,
}

pub struct Variable {
    pub name: String,
    pub description: String,
    pub kind: &'static str,
    pub causality: &'static str,
    pub variability: &'static str,
    pub unit: Option<String>,
    pub start: Option<f64>,
    pub min: Option<f64>,
    pub max: Option<f64>,
    /// Name of the declared type.
    pub declared_type: Option<String>,
    /// The items, if it is an enumeration.
    pub items: Vec<Item>,
}

/// The kinds of variables in the code, with the first words of their documentation.
const ROLES: [(&str, &str); 6] = [
    ("Input", "An input"),
    ("Parameter", "A parameter with a number, of anything but a tie or damper,"),
    ("Link", "A parameter of a tie or damper"),
    ("Text", "A parameter with a text"),
    ("Derived", "A calculated parameter"),
    ("Output", "An output"),
];

pub struct Item {
    pub name: String,
    pub value: i32,
    pub description: String,
}

/// Name space of the GUIDs of this FMU: a random UUID, fixed once.
const NAMESPACE: uuid::Uuid = uuid::uuid!("0a1f3f4e-7a35-4c7e-9f0e-3c8f5f6f2b61");

/// Reads and checks the file of a unit whose library has this identifier. An error names the element and the expected value.
pub fn read(text: &str, identifier: &str) -> Result<Description, String> {
    let document = Document::parse(text).map_err(|e| e.to_string())?;
    let root = document.root_element();
    let variables = elements(child(root, "ModelVariables")?).map(|node| variable(root, node));
    let variables = variables.collect::<Result<Vec<_>, _>>()?;
    let mut names = BTreeSet::new();
    for variable in &variables {
        if !names.insert(variable.name.as_str()) {
            return Err(format!("variable {} stands twice", variable.name));
        }
    }
    check_structure(root, &variables)?;
    let fmi3 = fmi3::write(root)?;
    let terminals = fmi3::terminals(text, root, &names)?;
    let text = of_fmi2(text, root, &variables)?;
    let guid = unique(&text);
    let packed = text.replacen(attribute(root, "guid")?, &guid, 1);
    let interfaces = ["ModelExchange", "CoSimulation"];
    for interface in root.children().filter(|node| interfaces.contains(&node.tag_name().name())) {
        if attribute(interface, "modelIdentifier")? != identifier {
            let name = interface.tag_name().name();
            return Err(format!("the modelIdentifier of {name} is the library's name, {identifier}"));
        }
    }
    Ok(Description { guid, variables, packed, fmi3, terminals })
}

/// Returns the GUID of this text.
pub fn unique(text: &str) -> String {
    format!("{{{}}}", uuid::Uuid::new_v5(&NAMESPACE, text.as_bytes()))
}

fn variable(root: Node, node: Node) -> Result<Variable, String> {
    let name = attribute(node, "name")?.to_string();
    let wrong = |fault: &str| format!("variable {name}: {fault}");
    let causality = match attribute(node, "causality")? {
        "input" => "Input",
        "parameter" => "Parameter",
        "calculatedParameter" => "CalculatedParameter",
        "output" => "Output",
        other => return Err(wrong(&format!("causality {other} is not used here"))),
    };
    let variability = match attribute(node, "variability")? {
        "continuous" => "Continuous",
        "discrete" => "Discrete",
        "fixed" => "Fixed",
        other => return Err(wrong(&format!("variability {other} is not used here"))),
    };
    let of_type = node.children().find(Node::is_element).ok_or_else(|| wrong("has no type"))?;
    let kind = match of_type.tag_name().name() {
        "Real" => "Real",
        "Integer" => "Integer",
        "Boolean" => "Boolean",
        "String" => "String",
        "Enumeration" => "Enumeration",
        other => return Err(wrong(&format!("type {other} is not used here"))),
    };
    let declared_type = of_type.attribute("declaredType");
    let declaration = match declared_type {
        Some(declared) => {
            Some(simple_type(root, declared).ok_or_else(|| wrong(&format!("type {declared} is not declared")))?)
        }
        None => None,
    };
    let number = |attribute: &str| -> Result<Option<f64>, String> {
        match of_type.attribute(attribute) {
            None => Ok(None),
            Some("") if kind == "String" => Ok(None),
            Some("true") if kind == "Boolean" => Ok(Some(1.0)),
            Some("false") if kind == "Boolean" => Ok(Some(0.0)),
            Some(text) => text.parse().map(Some).map_err(|_| wrong(&format!("{attribute} = {text} is no number"))),
        }
    };
    let (start, mut min, mut max) = (number("start")?, number("min")?, number("max")?);
    let items = declaration.map(items).transpose()?.unwrap_or_default();
    if kind == "Enumeration" {
        min = items.iter().map(|item| f64::from(item.value)).reduce(f64::min);
        max = items.iter().map(|item| f64::from(item.value)).reduce(f64::max);
    }
    let settable = matches!(causality, "Input" | "Parameter");
    if settable != of_type.has_attribute("start") {
        return Err(wrong("has a start value if, and only if, it is an input or a parameter"));
    }
    if start.is_some_and(|start| min.is_some_and(|min| start < min) || max.is_some_and(|max| start > max)) {
        return Err(wrong("starts outside its limits"));
    }
    let unit = declaration
        .and_then(|node| node.children().find(|n| n.has_tag_name("Real")))
        .and_then(|real| real.attribute("unit"))
        .map(str::to_string);
    if let Some(unit) = &unit
        && !child(root, "UnitDefinitions")?.children().any(|n| n.attribute("name") == Some(unit))
    {
        return Err(wrong(&format!("unit {unit} is not defined")));
    }
    if unit.as_deref() != of_type.attribute("unit") {
        return Err(wrong("has another unit than its type"));
    }
    if (kind == "Real") != unit.is_some() {
        return Err(wrong("has a unit if, and only if, it is Real"));
    }
    let description = attribute(node, "description")?.to_string();
    let declared_type = declared_type.map(str::to_string);
    Ok(Variable { name, description, kind, causality, variability, unit, start, min, max, declared_type, items })
}

/// Returns the file for FMI 2.0. It lacks the parts that only FMI 3.0 has, and has Integers instead of enumerations, which some importers
/// do not support.
fn of_fmi2(text: &str, root: Node, variables: &[Variable]) -> Result<String, String> {
    let mut edits = vec![(child(root, "Fmi3")?.range(), String::new())];
    // The comments describe the source file, not the packed one.
    let comments = root.document().root().descendants().filter(Node::is_comment);
    let in_fmi3 = |comment: &Node| comment.ancestors().any(|node| node.has_tag_name("Fmi3"));
    edits.extend(comments.filter(|comment| !in_fmi3(comment)).map(|comment| (comment.range(), String::new())));
    let unknowns = child(root, "ModelStructure")?.descendants();
    for attribute in unknowns.filter_map(|unknown| unknown.attribute_node(positions::FMI3_DEPENDENCIES)) {
        // Including the blank before it.
        edits.push((attribute.range().start - 1..attribute.range().end, String::new()));
    }
    let types = child(root, "TypeDefinitions")?.children();
    for declaration in types.filter(|n| n.descendants().any(|n| n.has_tag_name("Item"))) {
        edits.push((declaration.range(), String::new()));
    }
    let nodes = elements(child(root, "ModelVariables")?);
    for (node, variable) in nodes.zip(variables).filter(|(_, variable)| !variable.items.is_empty()) {
        let Variable { name, items, start, .. } = variable;
        let values: Vec<i32> = items.iter().map(|item| item.value).collect();
        let (Some(min), Some(max)) = (values.first(), values.last()) else { continue };
        if !values.iter().copied().eq(*min..=*max) {
            return Err(format!("variable {name}: its items are no Integers in a row"));
        }
        let choices: Vec<String> = items.iter().map(|item| format!("{} {}", item.value, item.name)).collect();
        let description =
            node.attribute_node("description").ok_or_else(|| format!("variable {name}: no description"))?;
        let end = description.range_value().end;
        edits.push((end..end, format!(": {}", choices.join(", "))));
        let of_type = node.children().find(Node::is_element).ok_or_else(|| format!("variable {name}: no type"))?;
        let start = start.map_or(String::new(), |start| format!(" start=\"{start}\""));
        edits.push((of_type.range(), format!("<Integer min=\"{min}\" max=\"{max}\"{start}/>")));
    }
    let lines = apply(text, edits);
    let lines = lines.lines().filter(|line| !line.trim().is_empty());
    Ok(lines.flat_map(|line| [line, "\n"]).collect())
}

pub fn items(declaration: Node) -> Result<Vec<Item>, String> {
    declaration
        .descendants()
        .filter(|node| node.has_tag_name("Item"))
        .map(|item| {
            let value = attribute(item, "value")?;
            let value = value.parse().map_err(|_| format!("item value {value} is no integer"))?;
            let text = |name: &str| attribute(item, name).map(str::to_string);
            Ok(Item { name: text("name")?, value, description: text("description")? })
        })
        .collect()
}

/// Checks that ModelStructure lists every output once and in order. The dependencies of its unknowns are inputs and states, or at
/// initialization inputs and parameters.
fn check_structure(root: Node, variables: &[Variable]) -> Result<(), String> {
    let structure = child(root, "ModelStructure")?;
    let indices = |list: &str| -> Result<Vec<usize>, String> {
        elements(child(structure, list)?).map(|node| index(node, "index")).collect()
    };
    let numbers = |causalities: &[&str]| -> Vec<usize> {
        (1..).zip(variables).filter(|(_, v)| causalities.contains(&v.causality)).map(|(i, _)| i).collect()
    };
    if indices("Outputs")? != numbers(&["Output"]) {
        return Err("ModelStructure/Outputs should list every output in order".into());
    }
    if indices("InitialUnknowns")? != numbers(&["CalculatedParameter", "Output"]) {
        return Err("ModelStructure/InitialUnknowns should list every calculated parameter and output in order".into());
    }
    let declared = child(root, "ModelVariables")?.descendants();
    let states = declared.filter_map(|node| node.attribute("derivative")).map(str::to_string);
    let later: Vec<String> = numbers(&["Input"]).iter().map(usize::to_string).chain(states).collect();
    let initially: Vec<String> = numbers(&["Input", "Parameter"]).iter().map(usize::to_string).collect();
    for (list, knowns, excluded) in [
        ("Outputs", &later, "no input and no state"),
        ("Derivatives", &later, "no input and no state"),
        ("InitialUnknowns", &initially, "no input and no parameter"),
    ] {
        // A unit without Model Exchange has no derivatives.
        for unknown in structure.children().filter(|node| node.has_tag_name(list)).flat_map(elements) {
            for dependency in attribute(unknown, "dependencies")?.split_whitespace() {
                if !knowns.iter().any(|known| known == dependency) {
                    let index = index(unknown, "index")?;
                    return Err(format!("unknown {index} of {list} depends on {dependency}, which is {excluded}"));
                }
            }
        }
    }
    Ok(())
}

fn index(node: Node, name: &str) -> Result<usize, String> {
    let text = attribute(node, name)?;
    text.parse().map_err(|_| format!("{name} = {text} is no index"))
}

fn simple_type<'a>(root: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    child(root, "TypeDefinitions").ok()?.children().find(|node| node.attribute("name") == Some(name))
}

impl Description {
    /// The table of variables in Rust.
    pub fn code(&self) -> String {
        let mut code = String::new();
        self.write_code(&mut code).expect("a String takes any text");
        code
    }

    fn write_code(&self, code: &mut String) -> std::fmt::Result {
        writeln!(code, "/// GUID that an importer must pass, computed from modelDescription.xml.")?;
        writeln!(code, "pub const GUID: &str = {:?};", self.guid)?;
        self.fmi3.write_code(code)?;
        writeln!(code, "/// A variable of modelDescription.xml; its number is its place in [`VARIABLES`].")?;
        writeln!(code, "#[derive(Clone, Copy, Debug, PartialEq, Eq)]\n#[repr(u32)]\npub enum Variable {{")?;
        for variable in &self.variables {
            writeln!(code, "    /// `{}`: {}.", variable.name, variable.description.replace('|', "\\|"))?;
            writeln!(code, "    {},", identifier(&variable.name))?;
        }
        writeln!(code, "}}")?;
        self.write_roles(code)?;
        self.write_choices(code)?;
        writeln!(code, "/// All variables, in the order of their value references.")?;
        writeln!(code, "pub static VARIABLES: [Metadata; {}] = [", self.variables.len())?;
        for v in &self.variables {
            let items: Vec<(i32, &str)> = v.items.iter().map(|item| (item.value, item.name.as_str())).collect();
            let [variable, role] = [identifier(&v.name), role(v).into()];
            writeln!(
                code,
                "    Metadata {{ variable: Variable::{variable}, name: {:?}, kind: Kind::{}, causality: Causality::{}, \
                 role: Role::{role}({role}::{variable}), variability: Variability::{}, unit: {:?}, start: {:?}, \
                 min: {:?}, max: {:?}, items: &{items:?} }},",
                v.name, v.kind, v.causality, v.variability, v.unit, v.start, v.min, v.max,
            )?;
        }
        writeln!(code, "];")?;
        let descriptions: Vec<&str> = self.variables.iter().map(|v| v.description.as_str()).collect();
        writeln!(code, "/// The descriptions of all variables, in the order of their value references.")?;
        writeln!(code, "pub static DESCRIPTIONS: [&str; {}] = {descriptions:?};", descriptions.len())
    }

    /// Writes one enumeration per kind. Code for a kind thus does not compile if it leaves out a variable.
    fn write_roles(&self, code: &mut String) -> std::fmt::Result {
        for (role_name, article) in ROLES {
            let of_role: Vec<&Variable> = self.variables.iter().filter(|v| role(v) == role_name).collect();
            if of_role.is_empty() {
                continue;
            }
            writeln!(code, "/// {article} of modelDescription.xml.")?;
            writeln!(code, "#[derive(Clone, Copy, Debug, PartialEq, Eq)]\npub enum {role_name} {{")?;
            for variable in &of_role {
                writeln!(code, "    /// `{}`.\n    {},", variable.name, identifier(&variable.name))?;
            }
            writeln!(
                code,
                "}}\nimpl {role_name} {{\n    /// All variables of this kind, in the order of their value references."
            )?;
            writeln!(code, "    pub const ALL: [{role_name}; {}] = [", of_role.len())?;
            for variable in &of_role {
                writeln!(code, "        {role_name}::{},", identifier(&variable.name))?;
            }
            writeln!(
                code,
                "    ];\n    /// Returns the variable.\n    #[allow(clippy::too_many_lines, reason = \"a line for each variable\")]\n    pub fn variable(self) -> Variable {{\n        match self {{"
            )?;
            for variable in &of_role {
                let name = identifier(&variable.name);
                writeln!(code, "            {role_name}::{name} => Variable::{name},")?;
            }
            writeln!(code, "        }}\n    }}\n}}")?;
        }
        Ok(())
    }

    /// Writes the items of each enumeration. Code for one thus does not compile if it leaves out an item.
    fn write_choices(&self, code: &mut String) -> std::fmt::Result {
        let mut written = BTreeSet::new();
        writeln!(code, "/// The enumerations of modelDescription.xml.\npub mod choices {{\n    use super::Choice;")?;
        for variable in &self.variables {
            let Some(name) = variable.declared_type.as_ref().filter(|_| !variable.items.is_empty()) else { continue };
            if !written.insert(name) {
                continue;
            }
            writeln!(code, "    /// Items of `{name}`.\n    #[derive(Clone, Copy, Debug, PartialEq, Eq)]")?;
            writeln!(code, "    pub enum {name} {{")?;
            for Item { name, value, description } in &variable.items {
                writeln!(code, "        /// {description}.\n        {name} = {value},")?;
            }
            writeln!(code, "    }}\n    impl Choice for {name} {{\n        const ALL: &'static [{name}] = &[")?;
            for item in &variable.items {
                writeln!(code, "            {name}::{},", item.name)?;
            }
            writeln!(
                code,
                "        ];\n        fn number(self) -> i32 {{\n            self as i32\n        }}\n    }}"
            )?;
        }
        writeln!(code, "}}")
    }
}

/// Returns the kind of a variable.
fn role(variable: &Variable) -> &'static str {
    match (variable.causality, variable.kind) {
        ("Input", _) => "Input",
        ("Parameter", "String") => "Text",
        ("Parameter", _) if ["tie_", "damper_"].iter().any(|link| variable.name.starts_with(link)) => "Link",
        ("Parameter", _) => "Parameter",
        ("CalculatedParameter", _) => "Derived",
        _ => "Output",
    }
}

/// `dimensionless.xi_v` → `DimensionlessXiV`.
pub fn identifier(name: &str) -> String {
    name.split(['.', '_'])
        .map(|part| {
            let mut characters = part.chars();
            characters
                .next()
                .map(|first| first.to_uppercase().chain(characters).collect::<String>())
                .unwrap_or_default()
        })
        .collect()
}
