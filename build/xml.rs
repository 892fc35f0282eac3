//! Elements and attributes that a file must have.

use roxmltree::Node;

/// Returns the first child of this name.
pub fn child<'a>(node: Node<'a, 'a>, name: &str) -> Result<Node<'a, 'a>, String> {
    node.children().find(|n| n.has_tag_name(name)).ok_or_else(|| format!("{} has no {name}", node.tag_name().name()))
}

/// Returns the elements in an element.
pub fn elements<'a>(node: Node<'a, 'a>) -> impl Iterator<Item = Node<'a, 'a>> {
    node.children().filter(Node::is_element)
}

/// Returns the value of an attribute.
pub fn attribute<'a>(node: Node<'a, '_>, name: &str) -> Result<&'a str, String> {
    node.attribute(name).ok_or_else(|| format!("a {} has no {name}", node.tag_name().name()))
}
