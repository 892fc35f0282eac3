//! modelDescription.xml → modelDescription.xml of FMI 3.0, and the variables that only FMI 3.0 has.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, Event};
use roxmltree::Node;

use crate::description::{identifier, unique};
use crate::positions::{ELEMENTS, FMI3_DEPENDENCIES};
use crate::xml::{attribute, child, elements};

/// The parts of the description that only FMI 3.0 has.
pub struct Fmi3 {
    /// The instantiation token.
    pub token: String,
    /// modelDescription.xml.
    pub packed: String,
    /// The variables that FMI 2.0 lacks.
    pub variables: Vec<Fmi3Variable>,
}

pub struct Fmi3Variable {
    pub name: String,
    pub description: String,
    /// The causality in FMI 3.0.
    pub causality: String,
    pub unit: Option<String>,
    pub start: Option<f64>,
    pub limits: [Option<f64>; 2],
}

/// Placeholder for the token until it is computed.
const PLACEHOLDER: &str = "{computed by the build}";

const ROOT: &str = "fmiModelDescription";
const TERMINALS: &str = "fmiTerminalsAndIcons";

type Attributes<'a> = Vec<(&'a str, &'a str)>;

/// Writes the file. The value references are those of FMI 2.0, followed by those of the variables only in FMI 3.0.
pub fn write(root: Node) -> Result<Fmi3, String> {
    let of_fmi3 = child(root, "Fmi3")?;
    let nodes: Vec<Node> = elements(child(of_fmi3, "ModelVariables")?).collect();
    let arrays = nodes.iter().flat_map(|node| {
        let elements = node.attribute(ELEMENTS).unwrap_or("").split_whitespace();
        elements.filter_map(|element| Some((element, node.attribute("valueReference")?)))
    });
    let mut file = File { writer: Writer::new_with_indent(Vec::new(), b' ', 2), arrays: arrays.collect() };
    file.description(root, of_fmi3, &nodes).map_err(|error| format!("modelDescription.xml of FMI 3.0: {error}"))?;
    let text = String::from_utf8(file.writer.into_inner()).map_err(|error| error.to_string())? + "\n";
    let token = unique(&text);
    let packed = text.replacen(PLACEHOLDER, &token, 1);
    Ok(Fmi3 { token, packed, variables: nodes.into_iter().map(read).collect::<Result<_, String>>()? })
}

/// Returns terminalsAndIcons.xml, after checking that its members are variables.
pub fn terminals(text: &str, root: Node, names: &BTreeSet<&str>) -> Result<String, String> {
    let terminals = child(child(root, "Fmi3")?, TERMINALS)?;
    for member in terminals.descendants().filter_map(|node| node.attribute("variableName")) {
        if !names.contains(member) {
            return Err(format!("terminal member {member} is no variable"));
        }
    }
    let indented = text[terminals.range()].replace("\n    ", "\n");
    Ok(format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{indented}\n"))
}

fn read(node: Node) -> Result<Fmi3Variable, String> {
    let name = attribute(node, "name")?.to_string();
    // For an array, the first of its start values, which are all equal.
    let number = |attribute: &str| match node.attribute(attribute).and_then(|text| text.split_whitespace().next()) {
        Some(text) => text.parse().map(Some).map_err(|_| format!("variable {name}: {attribute} = {text} is no number")),
        None => Ok(None),
    };
    let (start, limits) = (number("start")?, [number("min")?, number("max")?]);
    let description = attribute(node, "description")?.to_string();
    let causality = attribute(node, "causality")?.to_string();
    Ok(Fmi3Variable { description, causality, unit: node.attribute("unit").map(str::to_string), start, limits, name })
}

impl Fmi3 {
    /// Writes the token and the variables that FMI 2.0 lacks, in Rust.
    pub fn write_code(&self, code: &mut String) -> std::fmt::Result {
        writeln!(code, "/// Instantiation token that an importer of FMI 3.0 must pass, computed from its file.")?;
        writeln!(code, "pub const TOKEN: &str = {:?};", self.token)?;
        writeln!(code, "/// A variable that only FMI 3.0 has.")?;
        writeln!(code, "#[derive(Clone, Copy, Debug, PartialEq, Eq)]\npub enum Fmi3Variable {{")?;
        for Fmi3Variable { name, description, .. } in self.variables.iter().filter(|variable| !variable.is_indicator())
        {
            writeln!(code, "    /// `{name}`: {description}.\n    {},", identifier(name))?;
        }
        if self.variables.iter().any(Fmi3Variable::is_indicator) {
            writeln!(
                code,
                "    /// An event indicator of Model Exchange, by its place among them.\n    Indicator(usize),"
            )?;
        }
        writeln!(code, "}}")?;
        writeln!(
            code,
            "/// All variables that only FMI 3.0 has; their value references follow those of [`VARIABLES`]."
        )?;
        writeln!(code, "pub const FMI3_VARIABLES: [Fmi3Metadata; {}] = [", self.variables.len())?;
        let mut indicators = 0..;
        for variable in &self.variables {
            let Fmi3Variable { name, start, limits: [min, max], .. } = variable;
            let number = if variable.is_indicator() { indicators.next() } else { None };
            let variable = number.map_or_else(|| identifier(name), |number| format!("Indicator({number})"));
            writeln!(
                code,
                "    Fmi3Metadata {{ variable: Fmi3Variable::{variable}, name: {name:?}, start: {start:?}, min: {min:?}, max: {max:?} }},"
            )?;
        }
        writeln!(code, "];")
    }
}

impl Fmi3Variable {
    /// Whether it is an event indicator: no other variable is local.
    fn is_indicator(&self) -> bool {
        self.causality == "local"
    }
}

struct File<'a> {
    writer: Writer<Vec<u8>>,
    /// The arrays that take the place of scalars of FMI 2.0 among states and their derivatives, by value references.
    arrays: BTreeMap<&'a str, &'a str>,
}

type Written = Result<(), String>;

impl File<'_> {
    fn description(&mut self, root: Node, of_fmi3: Node, nodes: &[Node]) -> Written {
        self.event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
        let mut attributes = vec![("fmiVersion", "3.0"), ("instantiationToken", PLACEHOLDER)];
        let replaced = ["fmiVersion", "guid", "numberOfEventIndicators"];
        attributes.extend(attributes_of(root).into_iter().filter(|(name, _)| !replaced.contains(name)));
        self.event(Event::Start(BytesStart::new(ROOT).with_attributes(attributes)))?;
        let interface = |node: &Node| !["ModelVariables", TERMINALS].contains(&node.tag_name().name());
        elements(of_fmi3).filter(interface).try_for_each(|node| self.copy(node))?;
        self.copy(child(root, "UnitDefinitions")?)?;
        let types: Vec<Node> = elements(child(root, "TypeDefinitions")?).collect();
        self.element("TypeDefinitions", &[], &types, Self::declaration)?;
        self.copy(child(root, "LogCategories")?)?;
        self.copy(child(root, "DefaultExperiment")?)?;
        let variables: Vec<Node> = elements(child(root, "ModelVariables")?).chain(nodes.iter().copied()).collect();
        self.element("ModelVariables", &[], &variables, |file, node| {
            if node.has_tag_name("ScalarVariable") { file.variable(node) } else { file.copy(node) }
        })?;
        let structure = child(root, "ModelStructure")?;
        let outputs = elements(child(structure, "Outputs")?).map(|node| ("Output", node));
        let derivatives = structure.children().filter(|node| node.has_tag_name("Derivatives")).flat_map(elements);
        let derivatives =
            derivatives.filter(|node| node.attribute("index").is_none_or(|i| !self.arrays.contains_key(i)));
        // Those of arrays have no dependencies, which means all.
        let of_arrays = nodes.iter().copied().filter(|node| node.has_attribute("derivative"));
        let derivatives = derivatives.chain(of_arrays).map(|node| ("ContinuousStateDerivative", node));
        let initial = elements(child(structure, "InitialUnknowns")?).map(|node| ("InitialUnknown", node));
        let local = nodes.iter().filter(|node| node.attribute("causality") == Some("local"));
        let indicators = local.map(|&node| ("EventIndicator", node));
        // Arrays of results, whose dependencies are not declared.
        let arrays = || nodes.iter().copied().filter(|node| node.attribute("causality") == Some("output"));
        let outputs = outputs.chain(arrays().map(|node| ("Output", node)));
        let initial = initial.chain(arrays().map(|node| ("InitialUnknown", node)));
        let unknowns: Vec<(&str, Node)> = outputs.chain(derivatives).chain(initial).chain(indicators).collect();
        self.element("ModelStructure", &[], &unknowns, |file, (element, node)| {
            match node.attribute("valueReference") {
                Some(indicator) => file.leaf(element, &[("valueReference", indicator)]),
                None => file.unknown(element, node),
            }
        })?;
        self.event(Event::End(BytesEnd::new(ROOT)))
    }

    /// `SimpleType` with its type inside → an element named after the type.
    fn declaration(&mut self, node: Node) -> Written {
        let of_type = only_child(node)?;
        let (element, attributes) =
            (format!("{}Type", type_name(of_type)), [attributes_of(node), attributes_of(of_type)].concat());
        self.element(&element, &attributes, &elements(of_type).collect::<Vec<_>>(), Self::copy)
    }

    /// `ScalarVariable` with its type inside → an element named after the type. Continuous variables get `intermediateUpdate`.
    fn variable(&mut self, node: Node) -> Written {
        let of_type = only_child(node)?;
        let mut attributes = attributes_of(node);
        if attribute(node, "variability")? == "continuous" {
            attributes.push(("intermediateUpdate", "true"));
        }
        let text = of_type.has_tag_name("String");
        attributes.extend(attributes_of(of_type).into_iter().filter(|(name, _)| !(text && *name == "start")));
        let starts: Vec<&str> = of_type.attribute("start").filter(|_| text).into_iter().collect();
        self.element(type_name(of_type), &attributes, &starts, |file, start| file.leaf("Start", &[("value", start)]))
    }

    /// `Unknown` with indices → one with value references and the dependencies of FMI 3.0. References are the same numbers.
    fn unknown(&mut self, element: &str, node: Node) -> Written {
        let mut attributes = vec![("valueReference", attribute(node, "index")?)];
        let of_fmi3 = node.attribute(FMI3_DEPENDENCIES).unwrap_or("");
        let mut references = Vec::new();
        let dependencies = node.attribute("dependencies");
        for reference in dependencies.unwrap_or("").split_whitespace().chain(of_fmi3.split_whitespace()) {
            let reference = *self.arrays.get(reference).unwrap_or(&reference);
            if !references.contains(&reference) {
                references.push(reference);
            }
        }
        let list = references.join(" ");
        attributes.extend(dependencies.map(|_| ("dependencies", list.as_str())));
        let kinds = vec!["dependent"; references.len()].join(" ");
        attributes.extend(node.attribute("dependenciesKind").map(|_| ("dependenciesKind", kinds.as_str())));
        self.leaf(element, &attributes)
    }

    fn leaf(&mut self, name: &str, attributes: &[(&str, &str)]) -> Written {
        self.event(Event::Empty(BytesStart::new(name).with_attributes(attributes.iter().copied())))
    }

    fn copy(&mut self, node: Node) -> Written {
        self.element(node.tag_name().name(), &attributes_of(node), &elements(node).collect::<Vec<_>>(), Self::copy)
    }

    /// Writes an element with the content that `inside` makes from each node.
    fn element<T: Copy>(
        &mut self,
        name: &str,
        attributes: &[(&str, &str)],
        nodes: &[T],
        inside: impl Fn(&mut Self, T) -> Written,
    ) -> Written {
        if nodes.is_empty() {
            return self.leaf(name, attributes);
        }
        self.event(Event::Start(BytesStart::new(name).with_attributes(attributes.iter().copied())))?;
        nodes.iter().try_for_each(|&node| inside(self, node))?;
        self.event(Event::End(BytesEnd::new(name)))
    }

    fn event(&mut self, event: Event) -> Written {
        self.writer.write_event(event).map_err(|error| error.to_string())
    }
}

/// Returns the only element in an element: the type of a variable or of a declaration.
fn only_child<'a>(node: Node<'a, 'a>) -> Result<Node<'a, 'a>, String> {
    elements(node).next().ok_or_else(|| format!("{} has no type", node.tag_name().name()))
}

fn attributes_of<'a>(node: Node<'a, '_>) -> Attributes<'a> {
    let own = node.attributes().filter(|attribute| attribute.name() != ELEMENTS);
    own.map(|attribute| (attribute.name(), attribute.value())).collect()
}

/// Returns the FMI 3.0 name of a type of FMI 2.0.
fn type_name<'a>(node: Node<'a, '_>) -> &'a str {
    match node.tag_name().name() {
        "Real" => "Float64",
        "Integer" => "Int32",
        other => other,
    }
}
