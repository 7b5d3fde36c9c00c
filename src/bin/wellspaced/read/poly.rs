//! TetGen's `.poly` files: 1. points, 2. facets, 3. volume holes, 4. regions. Everything is read; what may be left
//! out in TetGen may be left out here. In a `.smesh` each facet is one polygon in one line, with its marker at the end. A file whose number of points is 0 takes them from the `.node` file beside it.

use std::path::Path;

use wellspaced::{Plc, PlcFacet, PlcRegion, PlcSegment};

use super::fields::{Fields, Lines, Numbered, Separator};
use super::node::{parse_points, read_node, Header};
use super::source::{Place, Source};
use crate::failure::Failure;

/// Reads the content of a `.poly` file; `source` learns where its elements stand.
pub fn parse_poly(path: &Path, content: &[u8], short: bool, source: &mut Source) -> Result<Plc, Failure> {
    let mut reader = Reader { lines: Lines::new(path, content, Separator::Blank), plc: Plc::default(), source };
    reader.points(path)?;
    let facets = reader.facets(short)?;
    let holes = reader.holes()?;
    let regions = reader.regions()?;
    let last = match (regions, holes, facets) {
        (Some(count), ..) => format!("the list of {count} regions"),
        (None, Some(count), _) => format!("the list of {count} holes"),
        (None, None, count) => format!("the list of {count} facets"),
    };
    reader.lines.expect_end(last)?;
    Ok(reader.plc)
}

struct Reader<'a, 's> {
    lines: Lines<'a>,
    plc: Plc,
    source: &'s mut Source,
}

impl<'a> Reader<'a, '_> {
    /// Part 1, here or in the `.node` file.
    fn points(&mut self, path: &Path) -> Result<(), Failure> {
        let header = Header::parse(self.lines.expect("number of points")?)?;
        let list = if header.count == 0 {
            read_node(&path.with_extension("node"), self.source)?
        } else {
            parse_points(&mut self.lines, &header, path, self.source)?
        };
        self.plc.points = list.points;
        self.plc.point_markers = list.markers;
        Ok(())
    }

    /// Part 2; the number of facets in the file.
    fn facets(&mut self, short: bool) -> Result<usize, Failure> {
        let mut fields = self.lines.expect("number of facets")?;
        let count = fields.count("list of facets", "number of facets")?;
        let markers = match fields.optional_count("list of facets", "number of markers")?.unwrap_or(0) {
            0 => false,
            1 => true,
            other => {
                let problem = format!("number of markers is {other}, expected 0 or 1");
                return Err(fields.wrong("list of facets", problem));
            }
        };
        for index in 0..count {
            let number = index + self.source.base;
            let fields = self.lines.expect(format_args!("facet {} of {count}", index + 1))?;
            if short {
                self.short_facet(number, markers, fields)?;
            } else {
                self.facet(number, markers, fields)?;
            }
        }
        Ok(count)
    }

    /// A facet of a `.smesh`: its polygon, then its marker.
    fn short_facet(&mut self, number: usize, markers: bool, fields: Fields<'a>) -> Result<(), Failure> {
        let element = format!("facet {number}");
        let place = Place { line: fields.line(), number };
        let (corners, mut rest) = self.polygon_in(&element, fields)?;
        let marker = if markers { rest.marker(&element)? } else { 0 };
        self.keep_facet(PlcFacet { polygons: vec![corners], marker, ..PlcFacet::default() }, place);
        Ok(())
    }

    fn facet(&mut self, number: usize, markers: bool, mut fields: Fields) -> Result<(), Failure> {
        let element = format!("facet {number}");
        let place = Place { line: fields.line(), number };
        let polygons = fields.count(&element, "number of polygons")?;
        if polygons == 0 {
            return Err(fields.wrong(element, "has no polygon"));
        }
        let holes = fields.optional_count(&element, "number of holes")?.unwrap_or(0);
        let marker = if markers { fields.marker(&element)? } else { 0 };
        let mut facet = PlcFacet { marker, ..PlcFacet::default() };
        for index in 1..=polygons {
            facet.polygons.push(self.polygon(&format!("{element}, polygon {index}"))?);
        }
        for index in 1..=holes {
            let hole = format!("{element}, hole {index}");
            let mut fields = self.lines.expect(&hole)?;
            fields.count(&hole, "number")?;
            facet.holes.push(fields.point(&hole)?);
        }
        self.keep_facet(facet, place);
        Ok(())
    }

    fn keep_facet(&mut self, facet: PlcFacet, place: Place) {
        let marker = facet.marker;
        if facet.polygons.iter().any(|polygon| polygon.len() > 2) {
            self.plc.facets.push(facet);
            self.source.facets.push(place);
            return;
        }
        // Without a polygon that spans a plane this is TetGen's way of writing segments and lone points.
        for polygon in &facet.polygons {
            if let [a, b] = polygon[..] {
                self.plc.segments.push(PlcSegment { ends: [a, b], marker });
                self.source.segments.push(place);
            }
        }
    }

    /// A polygon's corners; they may go on in the following lines.
    fn polygon(&mut self, element: &str) -> Result<Vec<u32>, Failure> {
        let fields = self.lines.expect(element)?;
        self.polygon_in(element, fields).map(|(corners, _)| corners)
    }

    /// The polygon that begins in this line, and what is left of the line where it ends.
    fn polygon_in(&mut self, element: &str, mut fields: Fields<'a>) -> Result<(Vec<u32>, Fields<'a>), Failure> {
        let count = fields.count(element, "number of corners")?;
        if count == 0 {
            return Err(fields.wrong(element, "has no corner"));
        }
        let mut corners = Vec::with_capacity(count.min(self.plc.points.len()));
        while corners.len() < count {
            let name = Numbered("corner", corners.len() + 1);
            let Some(corner) = fields.optional_count(element, name)? else {
                fields = self.lines.expect(format_args!("{element}, {name} of {count}"))?;
                continue;
            };
            match corner.checked_sub(self.source.base) {
                Some(index) if index < self.plc.points.len() => corners.push(index as u32),
                _ => return Err(fields.wrong(element, format_args!("{name} is point {corner}, which does not exist"))),
            }
        }
        match corners[..] {
            [a, b] if a == b => {
                Err(fields.wrong(element, format_args!("both ends are point {}", a as usize + self.source.base)))
            }
            _ => Ok((corners, fields)),
        }
    }

    /// Part 3, if it is there: the number of holes.
    fn holes(&mut self) -> Result<Option<usize>, Failure> {
        let Some(mut fields) = self.lines.next()? else { return Ok(None) };
        let count = fields.count("list of holes", "number of holes")?;
        for index in 0..count {
            let (element, mut fields, place) = self.seed("hole", index, count)?;
            self.plc.holes.push(fields.point(element)?);
            self.source.holes.push(place);
        }
        Ok(Some(count))
    }

    /// Part 4, if it is there: the number of regions.
    fn regions(&mut self) -> Result<Option<usize>, Failure> {
        let Some(mut fields) = self.lines.next()? else { return Ok(None) };
        let count = fields.count("list of regions", "number of regions")?;
        for index in 0..count {
            let (element, mut fields, place) = self.seed("region", index, count)?;
            self.plc.regions.push(PlcRegion {
                point: fields.point(element)?,
                attribute: fields.optional_real(element, "attribute")?.unwrap_or(0.0),
                // TetGen takes 0 and less for 'no limit'.
                max_volume: fields.optional_real(element, "largest volume")?.filter(|&volume| volume > 0.0),
            });
            self.source.regions.push(place);
        }
        Ok(Some(count))
    }

    /// The line of a hole or region, up to its coordinates.
    fn seed(
        &mut self,
        name: &'static str,
        index: usize,
        count: usize,
    ) -> Result<(Numbered, Fields<'a>, Place), Failure> {
        let mut fields = self.lines.expect(format_args!("{} of {count}", Numbered(name, index + 1)))?;
        let number = fields.count(Numbered(name, index + 1), "number")?;
        let place = Place { line: fields.line(), number };
        Ok((Numbered(name, number), fields, place))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;
    use wellspaced::{DomainElement, Error};

    use super::*;

    fn parse(text: &str) -> Result<(Plc, Source), String> {
        let path = Path::new("in.poly");
        let mut source = Source::new(path);
        match parse_poly(path, text.as_bytes(), false, &mut source) {
            Ok(plc) => Ok((plc, source)),
            Err(failure) => Err(failure.message().to_owned()),
        }
    }

    const ALL_PARTS: &str = "\
# part 1
5 3 1 1
1 0 0 0  0.5 11
2 1 0 0  0.5 12
3 1 1 0  0.5 13
4 0 1 0  0.5 14
5 .5 .5 1  0.5

# part 2
4 1
2 1 7   # a square with a segment and a hole
4 1 2
  3 4
2 1 3
1 .5 .5 0
1
3 1 2 5 # no marker
2 0 -3  # segments alone
2 4 5
2 3 5
1 0 9   # a lone point
1 5
# part 3
1
1 0.1 0.2 0.3
# part 4
2
1 0.4 0.5 0.6 21 0.125
2 0.7 0.8 0.9
";

    #[test]
    fn all_parts_of_a_file() {
        let (plc, source) = parse(ALL_PARTS).unwrap();
        assert_eq!(plc.points.len(), 5);
        assert_eq!(plc.points[4], DVec3::new(0.5, 0.5, 1.0));
        assert_eq!(plc.point_markers, [11, 12, 13, 14, 0]);
        let square = PlcFacet {
            polygons: vec![vec![0, 1, 2, 3], vec![0, 2]],
            holes: vec![DVec3::new(0.5, 0.5, 0.0)],
            marker: 7,
        };
        let triangle = PlcFacet { polygons: vec![vec![0, 1, 4]], holes: vec![], marker: 0 };
        assert_eq!(plc.facets, [square, triangle]);
        let segment = |ends| PlcSegment { ends, marker: -3 };
        assert_eq!(plc.segments, [segment([3, 4]), segment([2, 4])]);
        assert_eq!(plc.holes, [DVec3::new(0.1, 0.2, 0.3)]);
        let region = |point, attribute, max_volume| PlcRegion { point, attribute, max_volume };
        let expected =
            [region(DVec3::new(0.4, 0.5, 0.6), 21.0, Some(0.125)), region(DVec3::new(0.7, 0.8, 0.9), 0.0, None)];
        assert_eq!(plc.regions, expected);
        assert_eq!(source.facets, [Place { line: 11, number: 1 }, Place { line: 16, number: 2 }]);
        assert_eq!(source.segments, [Place { line: 18, number: 3 }; 2]);
        assert_eq!((source.base, source.points[0], source.holes[0].line), (1, 3, 25));
    }

    #[test]
    fn facets_of_an_smesh_are_one_line_each() {
        let text = "4 3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n3 1\n3 1 2 3 7\n3 1 2\n 4 -8\n2 3 4 9\n0\n0\n";
        let path = Path::new("in.smesh");
        let mut source = Source::new(path);
        let plc = parse_poly(path, text.as_bytes(), true, &mut source).unwrap();
        let facets: Vec<_> = plc.facets.iter().map(|f| (f.polygons[0].clone(), f.marker)).collect();
        assert_eq!(facets, [(vec![0, 1, 2], 7), (vec![0, 1, 3], -8)]);
        assert_eq!(plc.segments, [PlcSegment { ends: [2, 3], marker: 9 }]);
        assert_eq!(source.facets[1], Place { line: 8, number: 2 });
    }

    #[test]
    fn the_last_parts_may_be_left_out_and_unannounced_markers_are_ignored() {
        let text = "3 3\n0 0 0 0\n1 1 0 0\n2 0 1 0\n1 0\n1 0 5\n3 0 1 2\n";
        for end in ["", "0\n", "0\n0\n"] {
            let (plc, _) = parse(&format!("{text}{end}")).unwrap();
            assert_eq!(plc.facets, [PlcFacet { polygons: vec![vec![0, 1, 2]], ..PlcFacet::default() }]);
        }
    }

    #[test]
    fn each_defect_is_named_by_line_and_element() {
        let points = "3 3\n0 0 0 0\n1 1 0 0\n2 0 1 0\n";
        for (rest, message) in [
            ("", "in.poly:4: number of facets: missing, the file ends here"),
            ("1 2\n", "in.poly:5: list of facets: number of markers is 2, expected 0 or 1"),
            ("2 0\n1\n3 0 1 2\n", "in.poly:7: facet 2 of 2: missing, the file ends here"),
            ("1 0\n0\n", "in.poly:6: facet 0: has no polygon"),
            ("1 0\n1\n", "in.poly:6: facet 0, polygon 1: missing, the file ends here"),
            ("1 0\n2\n3 0 1 2\n0\n", "in.poly:8: facet 0, polygon 2: has no corner"),
            ("1 0\n1\n3 0 1 3\n", "in.poly:7: facet 0, polygon 1: corner 3 is point 3, which does not exist"),
            ("1 0\n1\n3 0 1\n# c\n", "in.poly:8: facet 0, polygon 1, corner 3 of 3: missing, the file ends here"),
            (
                "1 0\n1\n3 0 1\n\n-2\n",
                "in.poly:9: facet 0, polygon 1: corner 3 is \"-2\", expected a whole number, 0 or more",
            ),
            ("1 0\n1\n2 1 1\n", "in.poly:7: facet 0, polygon 1: both ends are point 1"),
            ("1 0\n1 1\n3 0 1 2\n", "in.poly:7: facet 0, hole 1: missing, the file ends here"),
            ("1 0\n1 1\n3 0 1 2\n1 0 0\n", "in.poly:8: facet 0, hole 1: z coordinate is missing"),
            ("1 1\n1 0 x\n3 0 1 2\n", "in.poly:6: facet 0: marker is \"x\", expected a whole number of 32 bits"),
            (
                "1 0\n1\n3 0 1 2\nhole\n",
                "in.poly:8: list of holes: number of holes is \"hole\", expected a whole number, 0 or more",
            ),
            ("1 0\n1\n3 0 1 2\n2\n1 0 0 0\n", "in.poly:9: hole 2 of 2: missing, the file ends here"),
            ("1 0\n1\n3 0 1 2\n0\n1\n4 0 0 z\n", "in.poly:10: region 4: z coordinate is \"z\", expected a number"),
            (
                "1 0\n1\n3 0 1 2\n0\n0\n7\n",
                "in.poly:10: line: unexpected, the list of 0 regions should have been the last",
            ),
        ] {
            assert_eq!(parse(&format!("{points}{rest}")).unwrap_err(), message, "{rest:?}");
        }
        // Numbered from 1, there is no point 0.
        let text = "3 3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n1 0\n1\n3 0 1 2\n";
        let message = "in.poly:7: facet 1, polygon 1: corner 1 is point 0, which does not exist";
        assert_eq!(parse(text).unwrap_err(), message);
    }

    #[test]
    fn what_the_core_finds_is_named_by_line_and_number() {
        let (_, source) = parse(ALL_PARTS).unwrap();
        let domain = |element| Error::InvalidDomain { element, problem: "is odd".to_owned() };
        for (error, message) in [
            (domain(DomainElement::Facet(1)), "in.poly:16: facet 2: is odd"),
            (domain(DomainElement::Segment(1)), "in.poly:18: segment of facet 3: is odd"),
            (domain(DomainElement::Point(4)), "in.poly:7: point 5: is odd"),
            (domain(DomainElement::Hole(0)), "in.poly:25: hole 1: is odd"),
            (domain(DomainElement::Region(1)), "in.poly:29: region 2: is odd"),
            (domain(DomainElement::Region(7)), "in.poly: region 7: is odd"),
            (domain(DomainElement::Whole), "in.poly: domain: is odd"),
            (Error::NotFinite { index: 0, point: DVec3::NAN }, "in.poly:3: point 1: a coordinate is not finite"),
        ] {
            assert_eq!(source.explain(&error).message(), message);
        }
    }

    #[test]
    fn points_may_stand_in_the_node_file_beside() {
        let folder = std::env::temp_dir().join(format!("wellspaced-poly-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("in.poly");
        let parse = || parse_poly(&path, b"0 3 0 0\n1 0\n1\n3 1 2 3\n0\n", false, &mut Source::new(&path));
        let missing = parse().unwrap_err().message().to_owned();
        std::fs::write(folder.join("in.node"), "3 3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n").unwrap();
        let plc = parse();
        std::fs::write(folder.join("in.node"), "3 3\n1 0 0 0\n2 1 0\n").unwrap();
        let malformed = parse().unwrap_err().message().to_owned();
        std::fs::remove_dir_all(&folder).unwrap();
        assert!(missing.contains("in.node: "), "{missing}");
        assert!(malformed.ends_with("in.node:3: point 2: z coordinate is missing"), "{malformed}");
        assert_eq!(plc.unwrap().facets[0].polygons, [[0, 1, 2]]);
    }

    proptest! {
        #[test]
        fn no_text_makes_the_reader_panic(text in "[-0-9 .#\nex]{0,200}") {
            let _ = parse(&text);
        }

        /// A file cut anywhere is an error with a line, or a whole file with fewer of the last parts.
        #[test]
        fn a_cut_file_is_named_by_line(cut in 0..ALL_PARTS.len()) {
            match parse(&ALL_PARTS[..cut]) {
                Ok((plc, _)) => prop_assert_eq!(plc.facets.len(), 2),
                Err(message) => prop_assert!(message.starts_with("in.poly:"), "{}", message),
            }
        }
    }
}
