//! modelDescription.xml of the packed FMU, as an importer reads it.

use roxmltree::{Document, Node};

/// A variable.
#[derive(Clone, Debug)]
pub struct Variable {
    pub name: String,
    pub reference: u32,
    /// `Real`, `Integer`, `Boolean` or `Enumeration`.
    pub kind: String,
    pub causality: String,
    pub min: Option<f64>,
    pub max: Option<f64>,
    /// Names of the variables on which an output depends by ModelStructure.
    pub dependencies: Vec<String>,
}

/// The parts of the description that the tests read.
pub struct Description {
    pub guid: String,
    pub variables: Vec<Variable>,
    pub log_categories: Vec<String>,
}

fn child<'a>(node: Node<'a, 'a>, name: &str) -> Node<'a, 'a> {
    node.children().find(|n| n.has_tag_name(name)).unwrap_or_else(|| panic!("no {name}"))
}

pub fn read(text: &str) -> Description {
    let document = Document::parse(text).unwrap();
    let root = document.root_element();
    let elements = |node: Node<'_, '_>| node.children().filter(Node::is_element).count();
    let mut variables: Vec<Variable> = Vec::with_capacity(elements(child(root, "ModelVariables")));
    for node in child(root, "ModelVariables").children().filter(Node::is_element) {
        let of_type = node.children().find(Node::is_element).unwrap();
        let number = |name| of_type.attribute(name).map(|text| text.parse().unwrap());
        variables.push(Variable {
            name: node.attribute("name").unwrap().into(),
            reference: node.attribute("valueReference").unwrap().parse().unwrap(),
            kind: of_type.tag_name().name().into(),
            causality: node.attribute("causality").unwrap().into(),
            min: number("min"),
            max: number("max"),
            dependencies: Vec::new(),
        });
    }
    for unknown in child(child(root, "ModelStructure"), "Outputs").children().filter(Node::is_element) {
        let index: usize = unknown.attribute("index").unwrap().parse().unwrap();
        let dependencies = unknown.attribute("dependencies").unwrap().split_whitespace();
        let names = dependencies.map(|i| variables[i.parse::<usize>().unwrap() - 1].name.clone()).collect();
        variables[index - 1].dependencies = names;
    }
    let log_categories =
        child(root, "LogCategories").children().filter_map(|node| node.attribute("name").map(str::to_string)).collect();
    Description { guid: root.attribute("guid").unwrap().into(), variables, log_categories }
}

impl Description {
    /// Returns the variable with this name in the planar unit, or its like in another unit.
    pub fn variable(&self, name: &str) -> &Variable {
        let name = crate::unit::name(name);
        self.variables.iter().find(|v| v.name == name).unwrap_or_else(|| panic!("there is no variable {name}"))
    }

    /// Real outputs.
    pub fn real_outputs(&self) -> impl Iterator<Item = &Variable> {
        self.outputs().filter(|v| v.kind == "Real")
    }

    /// Outputs.
    pub fn outputs(&self) -> impl Iterator<Item = &Variable> {
        self.variables.iter().filter(|v| v.causality == "output")
    }
}
