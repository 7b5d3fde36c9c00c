//! Input files: any bytes are read or refused with a line that names the file, and what the command writes it reads back.

use std::path::Path;

use wellspaced::DomainElement::{Facet, Hole, Point, Region, Segment};
use wellspaced::Error;

use crate::read::{parse, Content, InputFile};
use crate::write::write_poly;

/// The endings that there may be readers for; those that this version has none for are passed over.
const ENDINGS: [&str; 10] = ["poly", "node", "xyz", "off", "stl", "ply", "obj", "smesh", "mesh", "msh"];

pub fn run(data: &[u8]) {
    let Some((&first, content)) = data.split_first() else { return };
    // A folder that is not there: files beside the input are not found.
    let name = format!("/nowhere/in.{}", ENDINGS[usize::from(first) % ENDINGS.len()]);
    let Ok(file) = InputFile::parse(&name) else { return };
    match parse(&file.path, file.format, content) {
        Ok(input) => {
            let points = input.content.points();
            assert!(points.iter().all(|p| p.is_finite()), "{points:?}");
            if let Content::Domain(plc) = &input.content {
                // What the library would say of it has a place in the file.
                for i in [0, 1, 1 << 40] {
                    for element in [Point(i), Segment(i), Facet(i), Hole(i), Region(i)] {
                        let error = Error::InvalidDomain { element, problem: "is wrong".to_owned() };
                        let told = input.source.explain(&error);
                        assert!(told.message().starts_with("/nowhere/in."), "{}", told.message());
                    }
                }
                read_back(plc);
            }
        }
        Err(failure) => assert!(failure.message().starts_with("/nowhere/in."), "{}", failure.message()),
    }
}

/// Written as a `.poly` file and read again, a complex is the same.
fn read_back(plc: &wellspaced::Plc) {
    // Without points, a `.poly` file takes them from another; facets without a polygon of three corners are segments there, and lone points.
    let has_polygon = |facet: &wellspaced::PlcFacet| facet.polygons.iter().any(|polygon| polygon.len() > 2);
    if plc.points.is_empty() || !plc.facets.iter().all(has_polygon) {
        return;
    }
    let mut text = Vec::new();
    write_poly(&mut text, plc).expect("memory can be written to");
    let file = InputFile::parse("/nowhere/again.poly").expect("an ending that is known");
    let again = match parse(Path::new("/nowhere/again.poly"), file.format, &text) {
        Ok(input) => input.content,
        Err(failure) => panic!("{}\n{}", failure.message(), String::from_utf8_lossy(&text)),
    };
    let Content::Domain(again) = again else { panic!("a complex became points") };
    assert_eq!(again.points, plc.points);
    assert_eq!(again.facets.len() + again.segments.len(), plc.facets.len() + plc.segments.len());
    assert_eq!(again.holes, plc.holes);
    assert_eq!(again.regions, plc.regions);
}
