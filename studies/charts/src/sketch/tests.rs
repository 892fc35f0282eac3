use super::*;
use crate::glyphs::tests::bounds_of;
use rocking_block::block::{BlockParameters, Body, Common, KelvinVoigt, Outline, Springs, Supports};
use roxmltree::{Document, Node};

/// Returns a block of this size.
fn block(width: f64, height: f64, eccentricity: f64, foundation: Foundation) -> Block {
    let springs = KelvinVoigt::Springs(Springs { stiffness: 1.234e7, damping: 4.321e4 });
    let (outline, supports) = (Outline::Sizes { width, height, inertia: None }, Supports::of(foundation, springs));
    let common = Common { eccentricity, friction: 0.45, ..Common::default() };
    Block::new(&BlockParameters { outline, supports, common }).unwrap()
}

/// Returns a tie with all of its values.
fn cable(block: [f64; 2], ground: [f64; 2]) -> Tie {
    Tie {
        block,
        ground,
        stiffness: 2.5e6,
        pretension: 12e3,
        slack: 0.005,
        damping: 1e3,
        strength: 4e4,
        ..Tie::default()
    }
}

/// Returns sketches of all kinds.
fn sketches() -> Vec<Sketch> {
    let mut sketches = Vec::new();
    for (width, height) in [(0.3, 6.0), (0.612_345, 3.212_345), (1.2, 2.0), (2.0, 2.0), (3.0, 1.2), (4.0, 1.0)] {
        for foundation in [Foundation::Viscoelastic, Foundation::Rigid] {
            let [b, h] = [0.5 * width, 0.5 * height];
            let guys = [cable([-b, 0.9 * height], [-b - h, 0.0]), cable([b, 0.9 * height], [b + 1.2 * h, 0.0])];
            let walls = [cable([b, 0.8 * height], [b + 0.3, 0.8 * height]), cable([0.0, height], [0.0, -20.0])];
            let far = [cable([-b, height], [-20.0, 0.0]), cable([0.0, height], [0.0, -0.2 * height])];
            let of = |eccentricity: f64, ties: &[Tie]| {
                Sketch::of(&block(width, height, eccentricity * b, foundation).with_ties(ties).unwrap())
            };
            sketches.extend([
                of(0.0, &[]),
                of(0.0, &guys),
                of(-0.2, &walls),
                of(0.01, &far),
                // The ties of another block.
                of(0.3, &[cable([-3.0, 4.0], [-4.0, 0.0]), cable([1.0, 12.0], [1.0, -9.0])]),
                Sketch { height: None, ..of(0.7, &[]) },
                Sketch { height: Some(3.0 * h), ..of(-0.9, &[]) },
            ]);
        }
    }
    sketches
}

/// Returns left, top, right and bottom of a text of a drawing.
fn bounds(svg: &str, text: Node) -> [f32; 4] {
    let alone = format!("{}{}</svg>", &svg[..=svg.find('>').unwrap()], &svg[text.range()]);
    bounds_of(&alone)
}

/// Texts are inside the picture, and none covers another one.
#[test]
fn texts_do_not_overlap() {
    for sketch in sketches() {
        let svg = sketch.svg().unwrap();
        let document = Document::parse(&svg).unwrap();
        let number = |name: &str| document.root_element().attribute(name).unwrap().parse::<f32>().unwrap();
        let texts: Vec<_> = document.descendants().filter(|node| node.has_tag_name("text")).collect();
        let boxes: Vec<_> = texts.iter().map(|&text| bounds(&svg, text)).collect();
        let words = |i: usize| texts[i].descendants().filter_map(|node| node.text()).collect::<String>();
        assert!(texts.len() > 8, "{sketch:?}");
        for (i, a) in boxes.iter().enumerate() {
            let inside = a[0] > 0.0 && a[1] > 0.0 && a[2] < number("width") && a[3] < number("height");
            assert!(inside, "{} at {a:?} in {sketch:?}", words(i));
            for (j, b) in boxes.iter().enumerate().skip(i + 1) {
                let apart = a[2] < b[0] || b[2] < a[0] || a[3] < b[1] || b[3] < a[1];
                assert!(apart, "{} covers {} in {sketch:?}", words(i), words(j));
            }
        }
    }
}

/// The body, the centre of mass and the ties are to one scale, and the lines to the corners have the angles of the labels.
#[test]
fn sketches_are_to_scale() {
    for sketch in sketches() {
        let Layout { left, right, top, base, centre, ties, ends: [_, end], .. } = Layout::new(&sketch);
        let Body { b, h, .. } = sketch.block.body;
        let scale = (right - left) / (2.0 * b);
        let close = |a: f64, b: f64| (a - b).abs() < 1e-9 * (1.0 + b.abs());
        assert!(close(base - centre.1, scale * h) && close(base - top, scale * sketch.height.unwrap_or(2.0 * h)));
        assert!(close(centre.0 - 0.5 * (left + right), scale * sketch.block.eccentricity), "{sketch:?}");
        for (corner, side) in Corner::BOTH.into_iter().zip([centre.0 - left, right - centre.0]) {
            assert!(close(sketch.block.alpha_of(corner).tan(), side / (base - centre.1)), "{sketch:?}");
        }
        for (tie, drawn) in sketch.block.ties().iter().zip(ties) {
            assert!(drawn.block.0 > 0.0 && drawn.block.1 > 0.0 && drawn.end.0 > 0.0 && drawn.end.1 < end, "{drawn:?}");
            if tie.block[0].abs() > b || tie.block[1] > 2.0 * h {
                continue;
            }
            assert!(close(drawn.block.0 - 0.5 * (left + right), scale * tie.block[0]));
            assert!(close(base - drawn.block.1, scale * tie.block[1]));
            let is_far = tie.ground[0].abs().max(tie.ground[1].abs()) > 10.0;
            assert_eq!(drawn.kind == symbols::End::Broken, is_far, "{tie:?} of {sketch:?}");
            if tie.ground[1] == 0.0 && !is_far {
                assert!(close(drawn.end.0 - 0.5 * (left + right), scale * tie.ground[0]) && close(drawn.end.1, base));
            }
        }
    }
}

/// Pictures are as large as page or column allow, whatever the unit of length.
#[test]
fn the_size_of_the_block_does_not_matter() {
    let of = |factor: f64| Layout::new(&Sketch::of(&block(0.8 * factor, 3.2 * factor, 0.0, Foundation::Rigid)));
    let (metres, others) = (of(1.0), of(1e-3));
    for (a, b) in [(metres.left, others.left), (metres.top, others.top), (metres.ends[1], others.ends[1])] {
        assert!((a - b).abs() < 1e-6, "{a} {b}");
    }
}

/// Numbers carry the prefix of their unit.
#[test]
fn values_have_prefixes() {
    let numbers = [12.345, 999.0, 4.05e6, 9000.0, 3.2e10, 0.0].map(|value| engineering(value, "N/m"));
    assert_eq!(numbers, ["12.35 N/m", "999 N/m", "4.05 MN/m", "9 kN/m", "32 GN/m", "0 N/m"]);
}
