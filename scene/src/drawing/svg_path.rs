//! The visible paths of an SVG file as contours; Bezier curves are approximated by segments.
//!
//! usvg reads the document: it converts rect, circle, ellipse and polygon to paths and arcs to
//! cubic curves, and it resolves styles, `<use>` and transforms.

use crate::drawing::{
    contour::{Contour, WELD},
    css_geometry, svg_warnings,
    visible_paths::{Subpath, add_visible, is_filled, subpaths, transformed},
};
use support::{Extremes, Fault, ensure, fault};
use usvg::{
    ImageHrefResolver, Options, Path, Transform, Tree,
    roxmltree::{Document, ParsingOptions},
};

/// Removes the background colour of the root element and markers, which usvg would draw as paths,
/// and draws lines of no width, which are hairlines of a laser.
const OUTLINES_ALONE: &str = "svg { background-color: none !important } \
    * { marker-start: none !important; marker-mid: none !important; marker-end: none !important; \
    stroke-width: 1 !important }";

/// The contours of the visible paths of an SVG text in the coordinates of its page, y downwards,
/// and the warnings about what of it is not read.
pub(super) fn contours(svg: &str) -> Result<(Vec<Contour>, Vec<String>), Fault> {
    let options = Options {
        style_sheet: Some(OUTLINES_ALONE.to_owned()),
        // An image has no outline; its file is not opened.
        image_href_resolver: ImageHrefResolver {
            resolve_data: Box::new(|_, _, _| None),
            resolve_string: Box::new(|_, _| None),
        },
        ..Options::default()
    };
    let document = parsed(svg)?;
    let root = document.root_element().tag_name().name();
    ensure!(
        root == "svg",
        "the file is a document of the kind `{root}`; export the drawing as SVG or DXF"
    );
    css_geometry::refuse_unread(&document)?;
    let (tree, warnings) = svg_warnings::of(|| Tree::from_str(svg, &options));
    let tree = tree.map_err(not_svg)?;
    let mut paths = Vec::new();
    add_visible(tree.root(), &mut paths)?;
    if paths.is_empty() {
        let has = |name: &str| document.descendants().any(|node| node.has_tag_name(name));
        let alone = match () {
            () if has("text") => {
                ": it has text alone, which Inkscape converts (Path, Object to Path)"
            }
            () if has("image") => {
                ": it has a picture alone, which Inkscape traces (Path, Trace Bitmap)"
            }
            () => "",
        };
        let warnings = warnings.iter().map(|warning| format!(": {warning}"));
        return Err(no_path(&(alone.to_owned() + &warnings.collect::<String>())));
    }
    let of_path = |path: &Path| -> Vec<Contour> {
        let (transform, filled) = (path.abs_transform(), is_filled(path));
        let parts = subpaths(path).into_iter();
        parts.map(|part| part.contour(transform, filled)).collect()
    };
    Ok((paths.into_iter().flat_map(of_path).collect(), warnings))
}

pub(super) fn not_svg(error: usvg::Error) -> Fault {
    fault!("the file is not readable as SVG: {error}; save the drawing as plain SVG")
}

/// The error of a drawing without a path, and the reason in words, which may be empty.
pub(super) fn no_path(why: &str) -> Fault {
    format!(
        "there is no visible path in the file{why}; draw the outline as a path, polygon, rect, circle \
         or ellipse with a fill or a stroke, outside of <defs>, or in DXF as lines, arcs, polylines or splines in model \
         space on a layer that is on, thawed and plotted"
    )
    .into()
}

fn parsed(svg: &str) -> Result<Document<'_>, Fault> {
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    let document = Document::parse_with_options(svg, options);
    document.map_err(|error| not_svg(usvg::Error::ParsingFailed(error)))
}

impl Subpath {
    /// It on the page. Coordinates are rounded to 24 bits before the transform.
    fn contour(self, transform: Transform, filled: bool) -> Contour {
        let largest = self.points.as_flattened().iter().map(|c| c.abs());
        let largest = largest.largest();
        let scale = (f64::from(transform.sx) * f64::from(transform.sy)
            - f64::from(transform.kx) * f64::from(transform.ky))
        .abs()
        .sqrt();
        Contour {
            closed: self.closed,
            // A line has no inside.
            filled: filled && self.points.len() > 2,
            points: self.points.into_iter().map(|p| transformed(transform, p)).collect(),
            rounding: WELD * largest * scale,
            ..Contour::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::contour::MOST_POINTS;
    use crate::drawing::drawn_outline::of_text;
    use design::geometry::polygon;

    fn vertices(svg: &str) -> Result<Vec<[f64; 2]>, Fault> {
        of_text(svg, None).map(|outline| outline.vertices)
    }

    /// The outline of a document with this content.
    fn drawn(content: &str) -> Result<Vec<[f64; 2]>, Fault> {
        vertices(&format!("<svg xmlns=\"http://www.w3.org/2000/svg\">{content}</svg>"))
    }

    fn of(data: &str) -> Result<Vec<[f64; 2]>, Fault> {
        drawn(&format!("<path id=\"x\" d=\"{data}\" stroke='none'/>"))
    }

    fn stroked(data: &str) -> Result<Vec<[f64; 2]>, Fault> {
        drawn(&format!("<path d=\"{data}\" fill='none' stroke='#000'/>"))
    }

    /// [left, right, low, high] of the outline.
    fn bounds(outline: Result<Vec<[f64; 2]>, Fault>) -> [f64; 4] {
        let points = outline.unwrap_or_else(|error| panic!("{error}"));
        let extent = |axis: usize| {
            let values = || points.iter().map(|point| point[axis]);
            let high = values().fold(f64::NEG_INFINITY, f64::max);
            [values().fold(f64::INFINITY, f64::min), high]
        };
        let ([left, right], [low, high]) = (extent(0), extent(1));
        [left, right, low, high]
    }

    fn assert_near(found: [f64; 4], expected: [f64; 4]) {
        let near = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-5;
        let all_near = found.iter().zip(&expected).all(near);
        assert!(all_near, "{found:?} is not {expected:?}");
    }

    fn assert_refused(outline: Result<Vec<[f64; 2]>, Fault>, part: &str) {
        let error = outline.unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }

    const SMALL: &str = "<path d=\"M 0 0 H 1 V 1 H 0 Z\"/>";
    const LARGE: &str = "<path d=\"M 0 0 H 10 V 20 H 0 Z\"/>";

    #[test]
    fn lines_absolute_relative_and_repeated() {
        let square = [[0.0, 0.0], [10.0, 0.0], [10.0, -10.0], [0.0, -10.0]];
        for data in [
            "M0 0 L10 0 L10 10 L0 10 Z",
            "m0,0 10,0 0,10 -10,0z",
            "M0 0H10V10H0Z",
            "M0 0h1e1v10-0h-10z",
            "M0 0H10V10H0V0",
        ] {
            let found = of(data).unwrap_or_else(|error| panic!("{data}: {error}"));
            assert_eq!(found.first(), square.first(), "{data}");
            assert_eq!(found.last(), square.last(), "{data}");
        }
    }

    #[test]
    fn hidden_paths_are_skipped() {
        let expected = [0.0, 10.0, -20.0, 0.0];
        for hidden in [
            format!("<defs>{SMALL}</defs>"),
            format!("<!-- {SMALL} -->"),
            format!("<symbol>{SMALL}</symbol>"),
            format!("<clipPath id=\"c\">{SMALL}</clipPath>"),
            format!("<g display=\"none\">{SMALL}</g>"),
            format!("<g visibility=\"hidden\">{SMALL}</g>"),
            format!("<g opacity=\"0\">{SMALL}</g>"),
            format!("<g fill=\"none\">{SMALL}</g>"),
            format!("<g fill-opacity=\"0\">{SMALL}</g>"),
            SMALL.replace("<path", "<pathological"),
            "<image href=\"Cargo.toml\" width=\"1\" height=\"1\"/>".to_owned(),
        ] {
            let found = drawn(&(hidden.clone() + LARGE));
            assert_near(bounds(found), expected);
        }
        let background = format!("<svg style=\"background-color: #fff\">{LARGE}</svg>");
        assert_near(bounds(vertices(&background)), expected);
    }

    #[test]
    fn one_path_is_found_in_groups_and_uses_with_their_transforms() {
        let nested = format!("<g><g>{LARGE}</g></g>");
        let used = format!("<defs><g id=\"a\">{LARGE}</g></defs><use href=\"#a\" x=\"5\"/>");
        let turned = LARGE.replace("/>", " transform=\"rotate(90)\"/>");
        let grouped = format!("<g transform=\"translate(100 7) scale(2 1)\">{turned}</g>");
        let spaced = "<path d = \"M 0 0 H 10 V 20 H 0 Z\" />";
        for (content, expected) in [
            (&*nested, [0.0, 10.0, -20.0, 0.0]),
            (&used, [5.0, 15.0, -20.0, 0.0]),
            (&turned, [-20.0, 0.0, -10.0, 0.0]),
            (&grouped, [60.0, 100.0, -17.0, -7.0]),
            (spaced, [0.0, 10.0, -20.0, 0.0]),
        ] {
            assert_near(bounds(drawn(content)), expected);
        }
        assert_refused(drawn(&(nested + SMALL)), "cross or touch each other near (0, 0)");
    }

    #[test]
    fn curves_arcs_and_basic_shapes_have_their_areas() {
        let k = 0.552_284_75;
        let cubics = format!("M1 0 C1 {k} {k} 1 0 1 S-1 {k} -1 0 S-{k} -1 0 -1 S1 -{k} 1 0Z");
        let path = |data: &str| format!("<path d='{data}'/>");
        for (shape, area, error) in [
            (&*path(&cubics), std::f64::consts::PI, 1.5e-3),
            (&path("M -50 0 A 50 50 0 0 1 50 0 Z"), 3926.99, 1e-3),
            (&path("M 0 -1 a 2 1 0 1 1 0 2 a 2 1 0 1 1 0 -2 z"), std::f64::consts::TAU, 1e-3),
            ("<circle cx=\"7\" cy=\"5\" r=\"3\"/>", 28.274, 2e-3),
            ("<ellipse rx=\"3\" ry=\"2\"/>", 18.850, 2e-3),
            ("<rect width=\"4\" height=\"2\"/>", 8.0, 2e-3),
            ("<rect width=\"4\" height=\"2\" rx=\"0.5\"/>", 7.785, 2e-3),
            ("<polygon points=\"0,0 4,0 0,2\"/>", 4.0, 2e-3),
        ] {
            let found = drawn(shape).unwrap_or_else(|error| panic!("{shape}: {error}"));
            let found = polygon::area(&found).abs();
            assert!((found / area - 1.0).abs() < error, "{shape}: {found}");
        }
    }

    #[test]
    fn what_draws_nothing_and_hides_nothing_does_not_count() {
        let frame = "<clipPath id='f'><rect width='10' height='20'/></clipPath>";
        let framed = format!("{frame}<g clip-path='url(#f)'>{LARGE}</g>");
        let artboard =
            format!("<svg x='5' width='40' height='40' viewBox='0 0 20 20'>{LARGE}</svg>");
        let symbol = format!(
            "<symbol id='s' viewBox='0 0 10 20'>{LARGE}</symbol><use href='#s' width='10' height='20'/>"
        );
        let twice = format!("{LARGE}{}", LARGE.replace("/>", " fill='none' stroke='#000'/>"));
        let marked = format!(
            "<marker id='m'>{SMALL}</marker>{}",
            LARGE.replace("/>", " marker-mid='url(#m)' style='marker-start: url(#m)'/>")
        );
        for (content, expected) in [
            (marked, [0.0, 10.0, -20.0, 0.0]),
            (framed, [0.0, 10.0, -20.0, 0.0]),
            (artboard, [5.0, 25.0, -40.0, 0.0]),
            (symbol, [0.0, 10.0, -20.0, 0.0]),
            (twice, [0.0, 10.0, -20.0, 0.0]),
            (LARGE.replace("Z", "Z M 99 99 z"), [0.0, 10.0, -20.0, 0.0]),
            (LARGE.replace("d=\"", "d=\"M 99 99 z "), [0.0, 10.0, -20.0, 0.0]),
        ] {
            assert_near(bounds(drawn(&content)), expected);
        }
        let narrow = format!("{}<g clip-path='url(#f)'>{LARGE}</g>", frame.replace("'10'", "'9'"));
        assert_refused(drawn(&narrow), "clipPath `f`");
        assert_refused(drawn("<text y='9'>A</text>"), "text alone");
        let two = format!("{SMALL}<path d='M 5 0 H 10 V 20 H 5 Z'/>");
        assert_refused(drawn(&two), "2 pieces, by size #1 5 x 20 at (5, 0), #2 1 x 1 at (0, 0)");
    }

    #[test]
    fn styles_of_geometry_are_refused_by_their_name() {
        let styled = |style: &str| drawn(&LARGE.replace("/>", &format!(" style='{style}'/>")));
        assert_near(bounds(styled("fill: red; transform: none")), [0.0, 10.0, -20.0, 0.0]);
        let sheet = "<style>path.a{transform:scaleX(2)} #b{width:6px}</style>";
        for (content, style) in [
            (LARGE.replace("/>", " class='a' transform='scale(7)'/>"), "transform: scaleX(2)"),
            ("<rect id='b' width='1' height='1'/>".into(), "width: 6px"),
        ] {
            assert_refused(drawn(&format!("{sheet}{content}")), &format!("the style `{style}`"));
        }
        // What Inkscape says of its window and of a star is not of the drawing.
        let named = "xmlns:i='http://www.inkscape.org/namespaces/inkscape'";
        let view = format!("<i:namedview {named} i:zoom='0.74' zoom='2' i:cx='83'/>");
        let star = LARGE.replace("/>", &format!(" {named} i:zoom='2' i:transform='scale(9)'/>"));
        assert_near(bounds(drawn(&format!("{view}{star}"))), [0.0, 10.0, -20.0, 0.0]);
        for style in [
            "transform: rotate(90)",
            "translate: 5px",
            "transform-box: fill-box",
            "cx: 4px",
            "width: calc(1px + 2px)",
            "clip-path: circle(40%)",
        ] {
            assert_refused(styled(style), &format!("the style `{style}`"));
        }
        let clipped = LARGE.replace("/>", " clip-path='inset(1px)'/>");
        assert_refused(drawn(&clipped), "`clip-path: inset(1px)`");
    }

    #[test]
    fn warnings_of_the_parser_are_kept() {
        let of = |content: &str| {
            of_text(&format!("<svg xmlns='http://www.w3.org/2000/svg'>{content}</svg>"), None)
        };
        let sheet =
            "<style>@media print {path {fill: red}} path:nth-child(2) {display: none}</style>";
        let warnings = of(&format!("{sheet}{LARGE}")).unwrap().warnings;
        assert!(warnings.iter().any(|it| it.contains("@media")), "{warnings:?}");
        assert!(of(LARGE).unwrap().warnings.is_empty());
        let error = of("<rect width='ten' height='4'/>").unwrap_err().to_string();
        assert!(
            error.contains("no visible path in the file: ") && error.contains("'ten'"),
            "{error}"
        );
    }

    #[test]
    fn lines_of_no_width_are_lines_and_pictures_are_named() {
        for stroke in ["stroke-width='0'", "style='stroke-width:0;-inkscape-stroke:hairline'"] {
            let line = LARGE.replace("/>", &format!(" fill='none' stroke='red' {stroke}/>"));
            assert_near(bounds(drawn(&line)), [0.0, 10.0, -20.0, 0.0]);
        }
        assert_refused(
            drawn("<image width='3' height='2' href='data:image/png;base64,AA=='/>"),
            "a picture alone",
        );
    }

    #[test]
    fn what_hides_a_part_of_the_path_is_refused_by_its_name() {
        for (element, attribute) in [("clipPath", "clip-path"), ("mask", "mask")] {
            let part = format!("<{element} id=\"part\">{SMALL}</{element}>");
            let cut = format!("{part}<g {attribute}=\"url(#part)\">{LARGE}</g>");
            assert_refused(drawn(&cut), &format!("{element} `part`"));
        }
    }

    #[test]
    fn an_outline_of_too_many_points_is_refused() {
        let corners = |count: usize| {
            let points = (1..count).map(|x| format!(" {x} {}", x % 2));
            "M0 0".to_owned() + &points.collect::<String>()
        };
        let closed = |count: usize| corners(count) + &format!(" {count} 9 0 9Z");
        assert_refused(of(&closed(MOST_POINTS)), "at most 100000");
        assert!(of(&closed(1000)).is_ok());
    }

    #[test]
    fn outlines_that_cross_or_touch_themselves_are_refused() {
        for data in [
            "M 0 -80 L 47 65 L -76 -25 L 76 -25 L -47 65 Z", // a star in one stroke
            "M 0 0 L 10 10 L 10 0 L 0 10 Z",                 // a bow tie
            "M 0 0 L 5 5 L 10 0 V 10 L 5 5 L 0 10 Z",        // two triangles that meet in a point
            "M 0 0 C 40 30 -30 30 10 0 V -5 H 0 V 20 Z",     // a line through a curve
            "M 0 0 H 10 V 5 H 20 V 0 H 5 V -5 H 0 Z",        // a line along a line
        ] {
            assert_refused(of(data), "crosses or touches itself near (");
        }
        let error = of("M 0 0 L 10 10 L 10 0 L 0 10 Z").unwrap_err();
        assert!(error.to_string().contains("(5, 5)"), "{error}");
    }

    #[test]
    fn straight_curves_and_slits_do_not_cross() {
        // All edges of a side lie on one line whose slope is not exact in binary.
        of("M 0 0 C 0.1 0.3 0.2 0.6 0.3 0.9 L 0.7 1.1 C 0.5 0.6 0.6 0.1 0.1 -0.3 Z").unwrap();
        of("M 0 0 H 10 V 10 H 5.01 V 1 H 5 V 10 H 0 Z").unwrap();
        of("M 1000 1000 a 1 1 0 0 1 2 0 a 1 1 0 0 1 -2 0 z").unwrap();
    }

    #[test]
    fn files_without_an_outline_are_refused() {
        let hidden = format!("<defs>{SMALL}</defs>");
        for (outline, part) in [
            (vertices(""), "the file is empty"),
            (vertices(" \n"), "the file is empty"),
            (vertices("x,y\n0,0\n"), "begins with `x,y`"),
            (vertices("<html/>"), "a document of the kind `html`"),
            (vertices("<svg><g></svg>"), "not readable as SVG"),
            (vertices("<svg/>"), "no visible path"),
            (drawn(&hidden), "no visible path"),
            (of("M0 0 L x"), "no visible path"),
            (of("M0 0 L1 0 L1 1 Z M5 5 L6 6 H5Z"), "#2 1 x 1 at (5, 5)"),
            (of("M0 0 L1 0 L1 1 Z L6 6 H5Z"), "#2 1 x 1 at (0, 0)"),
            (stroked("M0 0 H10 V10"), "ends open at (10, 10), 14.14214 from"),
            (stroked("M0 0 H10 V10 L x 3 Z"), "ends open at (10, 10)"),
            (of("M0 0 H10 Z"), "2 different points"),
            // At the coordinates of a map numbers of 24 bits end at half a metre.
            (drawn("<circle cx='5000000' cy='7' r='3'/>"), "times its own size away"),
        ] {
            assert_refused(outline, part);
        }
    }
}
