//! A drawing → its labels.

/// Returns the labels of a drawing, with subscripts in line.
pub fn labels(svg: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(svg).unwrap();
    let texts = document.descendants().filter(|node| node.has_tag_name("text"));
    texts
        .map(|node| {
            let parts = node.descendants().filter(|part| part.is_text()).filter_map(|part| part.text());
            parts.collect::<String>().trim().to_string()
        })
        .collect()
}
