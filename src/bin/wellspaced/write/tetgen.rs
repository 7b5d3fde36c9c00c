//! TetGen's text files, zero-based: `.node`, `.ele`, and `.poly` for a domain.

use std::io::{self, Write};

use glam::DVec3;
use wellspaced::Plc;

use super::number::{Line, Shortest};

/// Writes points as a `.node` file, with their markers if any is not 0.
pub fn write_node(out: &mut dyn Write, points: &[DVec3], markers: &[i32]) -> io::Result<()> {
    let marked = markers.iter().any(|&marker| marker != 0);
    writeln!(out, "{} 3 0 {}", points.len(), u8::from(marked))?;
    write_points(out, points, if marked { markers } else { &[] })
}

/// Writes numbered points, each with its marker if there are any.
fn write_points(out: &mut dyn Write, points: &[DVec3], markers: &[i32]) -> io::Result<()> {
    let mut line = Line::default();
    for (number, point) in points.iter().enumerate() {
        line.push(number);
        point.to_array().into_iter().try_for_each(|x| line.push_real(x))?;
        if let Some(&marker) = markers.get(number) {
            line.push(marker);
        }
        line.end(out)?;
    }
    Ok(())
}

/// Writes tetrahedra as an `.ele` file, in our orientation, with their regions' attributes if there are any.
pub fn write_ele(out: &mut dyn Write, tetrahedra: &[[u32; 4]], attributes: &[f64]) -> io::Result<()> {
    writeln!(out, "{} 4 {}", tetrahedra.len(), u8::from(!attributes.is_empty()))?;
    let mut line = Line::default();
    for (number, corners) in tetrahedra.iter().enumerate() {
        line.push(number);
        corners.iter().for_each(|&corner| line.push(corner));
        attributes.get(number).map_or(Ok(()), |&attribute| line.push_real(attribute))?;
        line.end(out)?;
    }
    Ok(())
}

/// Writes faces as a `.face` file, or edges as an `.edge` file, with their markers.
pub fn write_marked<const N: usize>(out: &mut dyn Write, elements: &[([u32; N], i32)]) -> io::Result<()> {
    writeln!(out, "{} 1", elements.len())?;
    let mut line = Line::default();
    for (number, (corners, marker)) in elements.iter().enumerate() {
        line.push(number);
        corners.iter().for_each(|&corner| line.push(corner));
        line.push(*marker);
        line.end(out)?;
    }
    Ok(())
}

/// Writes a domain as a `.poly` file. Segments become facets of two corners, as TetGen has them; point markers
/// are written if there are any.
pub fn write_poly(out: &mut dyn Write, plc: &Plc) -> io::Result<()> {
    let point_markers = plc.point_markers.len() == plc.points.len() && !plc.points.is_empty();
    writeln!(out, "{} 3 0 {}", plc.points.len(), u8::from(point_markers))?;
    write_points(out, &plc.points, if point_markers { &plc.point_markers } else { &[] })?;
    let mut facet_markers = plc.facets.iter().map(|f| f.marker).chain(plc.segments.iter().map(|s| s.marker));
    let facet_markers = facet_markers.any(|marker| marker != 0);
    writeln!(out, "{} {}", plc.facets.len() + plc.segments.len(), u8::from(facet_markers))?;
    for facet in &plc.facets {
        match (facet_markers, facet.holes.len()) {
            (true, holes) => writeln!(out, "{} {holes} {}", facet.polygons.len(), facet.marker)?,
            (false, 0) => writeln!(out, "{}", facet.polygons.len())?,
            (false, holes) => writeln!(out, "{} {holes}", facet.polygons.len())?,
        }
        for polygon in &facet.polygons {
            write!(out, "{}", polygon.len())?;
            for corner in polygon {
                write!(out, " {corner}")?;
            }
            writeln!(out)?;
        }
        write_points(out, &facet.holes, &[])?;
    }
    for segment in &plc.segments {
        match facet_markers {
            true => writeln!(out, "1 0 {}", segment.marker)?,
            false => writeln!(out, "1")?,
        }
        writeln!(out, "2 {} {}", segment.ends[0], segment.ends[1])?;
    }
    writeln!(out, "{}", plc.holes.len())?;
    write_points(out, &plc.holes, &[])?;
    writeln!(out, "{}", plc.regions.len())?;
    for (number, region) in plc.regions.iter().enumerate() {
        let [x, y, z] = region.point.to_array().map(Shortest);
        write!(out, "{number} {x} {y} {z} {}", Shortest(region.attribute))?;
        match region.max_volume {
            Some(volume) => writeln!(out, " {}", Shortest(volume))?,
            None => writeln!(out)?,
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use proptest::prelude::*;
    use wellspaced::{PlcFacet, PlcRegion, PlcSegment};

    use super::*;
    use crate::read::{parse, Content, Format};

    fn text(write: impl Fn(&mut dyn Write) -> io::Result<()>) -> String {
        let mut bytes = Vec::new();
        write(&mut bytes).unwrap();
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn node_and_ele_are_zero_based() {
        let points = [DVec3::new(0.1, -2.0, 1e-9), DVec3::ZERO];
        assert_eq!(text(|out| write_node(out, &points, &[])), "2 3 0 0\n0 0.1 -2 1e-9\n1 0 0 0\n");
        assert_eq!(text(|out| write_ele(out, &[[3, 1, 2, 0]], &[])), "1 4 0\n0 3 1 2 0\n");
    }

    #[test]
    fn a_box_is_written_as_the_data_sets_are() {
        let plc = Plc::boxed(DVec3::splat(-1.0), DVec3::splat(1.0), [DVec3::new(0.5, 0.0, 0.25)]);
        let text = text(|out| write_poly(out, &plc));
        assert!(text.starts_with("9 3 0 0\n0 -1 -1 -1\n1 1 -1 -1\n2 -1 1 -1\n"), "{text}");
        assert!(text.ends_with("8 0.5 0 0.25\n6 0\n1\n4 0 1 3 2\n1\n4 4 5 7 6\n1\n4 0 1 5 4\n1\n4 2 3 7 6\n1\n4 0 2 6 4\n1\n4 1 3 7 5\n0\n0\n"), "{text}");
    }

    fn point() -> impl Strategy<Value = DVec3> {
        let coordinate = || prop_oneof![-1e3..1e3f64, -1e-20..1e-20f64, -1e40..1e40f64, Just(0.0), Just(-3.0)];
        (coordinate(), coordinate(), coordinate()).prop_map(|(x, y, z)| DVec3::new(x, y, z))
    }

    /// Any complex with at least three points.
    fn plc() -> impl Strategy<Value = Plc> {
        let lists = (prop::collection::vec((point(), -9..9i32), 3..40), any::<bool>());
        lists.prop_flat_map(|(points, marked)| {
            let count = points.len() as u32;
            let index = move || 0..count;
            let face = prop::collection::vec(index(), 3..7);
            let inner = prop::collection::vec(
                prop_oneof![
                    prop::collection::vec(index(), 3..7),
                    index().prop_map(|i| vec![i]),
                    (index(), 1..count).prop_map(move |(i, step)| vec![i, (i + step) % count]),
                ],
                0..3,
            );
            let facet = (face, inner, prop::collection::vec(point(), 0..3), -9..9i32);
            let facet = facet.prop_map(|(face, inner, holes, marker)| PlcFacet {
                polygons: std::iter::once(face).chain(inner).collect(),
                holes,
                marker,
            });
            let segment = (index(), 1..count, -9..9i32);
            let segment =
                segment.prop_map(move |(i, step, marker)| PlcSegment { ends: [i, (i + step) % count], marker });
            let region = (point(), -5.0..5.0f64, prop::option::of(1e-9..1e9f64));
            let region = region.prop_map(|(point, attribute, max_volume)| PlcRegion { point, attribute, max_volume });
            let (points, markers): (Vec<_>, Vec<_>) = points.into_iter().unzip();
            let lists = (
                prop::collection::vec(facet, 0..5),
                prop::collection::vec(segment, 0..4),
                prop::collection::vec(point(), 0..3),
                prop::collection::vec(region, 0..3),
            );
            lists.prop_map(move |(facets, segments, holes, regions)| Plc {
                points: points.clone(),
                point_markers: if marked { markers.clone() } else { Vec::new() },
                segments,
                facets,
                holes,
                regions,
            })
        })
    }

    proptest! {
        #[test]
        fn a_domain_reads_back_as_itself(plc in plc()) {
            let text = text(|out| write_poly(out, &plc));
            let input = parse(Path::new("in.poly"), Format::Poly, text.as_bytes()).unwrap();
            prop_assert_eq!(input.content, Content::Domain(plc));
        }

        #[test]
        fn points_read_back_as_themselves(points in prop::collection::vec(point(), 1..30)) {
            let text = text(|out| write_node(out, &points, &[]));
            let input = parse(Path::new("in.node"), Format::Node, text.as_bytes()).unwrap();
            prop_assert_eq!(input.content, Content::Points(points));
        }
    }
}
