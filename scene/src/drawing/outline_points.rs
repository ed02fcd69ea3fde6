//! The vertices of an outline in a text with one point a line. Lines above the first point name the
//! outline or its columns: without names the columns are x and y, behind a number that counts the
//! lines or before a constant. Blank lines separate blocks, which are joined where their ends meet;
//! a line above them may count their points, as in airfoils in the form of Lednicer.

use crate::drawing::{contour::Contour, drawn_outline::listed, joined_lines::joined};
use std::path::Path;
use support::{
    Fault, Point, at, fault, text_file,
    text_table::{TextRow, TextTable},
};

/// Units behind the names of columns, with their length (mm).
const UNITS: [(&str, f64); 5] =
    [("mm", 1.0), ("cm", 10.0), ("m", 1000.0), ("in", 25.4), ("inch", 25.4)];

/// Where x and y stand in a line, and the length of their unit (mm).
struct CoordinateColumns {
    places: [usize; 2],
    unit: f64,
}

/// The points in a file (mm), in its order.
pub(crate) fn read(path: &Path) -> Result<Vec<Point>, Fault> {
    let file = path.display();
    let text =
        text_file::read(path).map_err(at(format!("cannot read the target outline {file}")))?;
    points(&text).map_err(|(line, what)| fault!("{file}:{line}: {what}"))
}

/// The points of a text (mm); an error has the number of its line.
fn points(text: &str) -> Result<Vec<Point>, (u64, String)> {
    let table = TextTable::parse(text);
    let number = |cell: &String| table.style.number(cell);
    let is_filled = |row: &&TextRow| row.cells.iter().any(|cell| !cell.is_empty());
    let rows = table.rows.iter().filter(|row| !row.is_comment()).filter(is_filled);
    let is_point = |row: &TextRow| {
        let digit = |c: char| c.is_ascii_digit();
        let begins = row.cells[0].trim_start_matches(['-', '+', '.', ',']);
        let numbers = row.cells.iter().filter_map(&number).count();
        begins.starts_with(digit) || (row.cells[0].contains(digit) && numbers > 0)
    };
    let (above, below): (Vec<_>, Vec<_>) = {
        let mut found = false;
        rows.partition(|row| {
            found |= is_point(row);
            !found
        })
    };
    let blank = |line: &str| line.trim_matches([' ', '\t', ',', ';']).is_empty();
    let blank: Vec<bool> = text.lines().map(blank).collect();
    // The reader of cells counts the line of a row from the blank ones above it.
    let begins = |row: &TextRow| {
        let line = row.line as usize;
        (line.max(2) - 1..=line).any(|line| blank.get(line - 1) == Some(&true))
    };
    let numbers = |row: &TextRow| -> Vec<f64> { row.cells.iter().filter_map(number).collect() };
    let counts = below.first().filter(|row| row.cells.iter().all(|cell| number(cell).is_some()));
    let counts = counts.map(|row| numbers(row)).unwrap_or_default();
    let whole = counts.iter().all(|count| *count >= 1.0 && count.fract() == 0.0);
    let counted = whole && counts.iter().sum::<f64>() + 1.0 == below.len() as f64;
    let nose = counts.first().map_or(1, |upper| (*upper as usize).saturating_add(1));
    let is_count = counted
        && match counts.len() {
            1 => true,
            2 => begins(below[nose]) || numbers(below[1]) == numbers(below[nose]),
            _ => false,
        };
    let below = &below[usize::from(is_count)..];
    let begins = |i: usize| i > 0 && (begins(below[i]) || (is_count && i + 1 == nose));
    let Some(first) = below.first() else {
        return Ok(Vec::new());
    };
    let columns = columns(above.last(), below, &table)?;
    let point = |row: &&TextRow| {
        let coordinate = |place: usize| Some(columns.unit * number(row.cells.get(place)?)?);
        let [x, y] = columns.places.map(coordinate);
        let text = row.cells.join("  ");
        let written = text.escape_debug();
        let alike = row.cells.len() == first.cells.len();
        (x.zip(y).filter(|_| alike).map(Point::from)).ok_or_else(|| {
            (row.line, format!("`{written}` is no point: write x and y in mm, as in `12.5, 40`"))
        })
    };
    let points = below.iter().map(point).collect::<Result<Vec<_>, _>>()?;
    let starts: Vec<usize> = (0..points.len()).filter(|i| *i == 0 || begins(*i)).collect();
    joined_blocks(points, &starts).map_err(|(start, what)| (below[start].line, what))
}

/// The points of the outline whose blocks begin at `starts`; an error has the start of the block
/// that does not belong to it.
fn joined_blocks(mut points: Vec<Point>, starts: &[usize]) -> Result<Vec<Point>, (usize, String)> {
    let mut blocks: Vec<_> = starts.iter().rev().map(|start| points.split_off(*start)).collect();
    blocks.reverse();
    // Between single points and pairs blank lines have no meaning.
    if blocks.len() == 1 || blocks.iter().all(|block| block.len() < 3) {
        return Ok(blocks.concat());
    }
    if let Some(alone) = blocks.iter().position(|block| block.len() == 1) {
        return Err((starts[alone], "a point stands alone between blank lines".into()));
    }
    let contour = |points| Contour { points, ..Contour::default() };
    let mut outlines = joined(blocks.into_iter().map(contour).collect());
    if outlines.len() == 1 {
        return Ok(outlines.remove(0).points);
    }
    outlines.iter_mut().for_each(|outline| outline.closed = true);
    let what = format!(
        "a blank line begins another outline: there are {}, {}; keep one, or delete blank lines within it",
        outlines.len(),
        listed(outlines.iter().enumerate())
    );
    Err((starts[1], what))
}

/// The columns of rows, from the line above them if it names columns; an error has its line.
fn columns(
    above: Option<&&TextRow>,
    rows: &[&TextRow],
    table: &TextTable,
) -> Result<CoordinateColumns, (u64, String)> {
    // A title such as `NACA 2412` names no columns.
    let head = above.filter(|head| {
        head.cells.len() == rows[0].cells.len()
            && head.cells.iter().all(|cell| table.style.number(cell).is_none())
    });
    let columns = head.map_or_else(|| unnamed(rows, table), |head| named(&head.cells));
    columns.map_err(|what| (head.unwrap_or(&rows[0]).line, what))
}

/// The columns that a head names x and y.
fn named(head: &[String]) -> Result<CoordinateColumns, String> {
    let parts = |cell: &String| -> Vec<String> {
        let letters = cell.to_lowercase();
        let words = letters.split(|c: char| !c.is_alphanumeric());
        words.filter(|word| !word.is_empty()).map(str::to_owned).collect()
    };
    let parts: Vec<Vec<String>> = head.iter().map(parts).collect();
    let place =
        |name: &str| parts.iter().position(|words| words.first().is_some_and(|it| it == name));
    let (Some(x), Some(y)) = (place("x"), place("y")) else {
        let head = head.join(", ");
        return Err(format!("`{head}` names no columns x and y: correct it, or write # before it"));
    };
    let unit = |place: usize| match parts[place].get(1) {
        None => Ok(1.0),
        Some(unit) => {
            (UNITS.iter().find(|(name, _)| name == unit)).map(|(_, length)| *length).ok_or_else(
                || format!("`{unit}` is no unit of points that is known: use mm, cm, m or in"),
            )
        }
    };
    match (unit(x)?, unit(y)?) {
        (of_x, of_y) if of_x == of_y => Ok(CoordinateColumns { places: [x, y], unit: of_x }),
        _ => Err("x and y have different units".into()),
    }
}

/// The columns of lines without a head.
fn unnamed(rows: &[&TextRow], table: &TextTable) -> Result<CoordinateColumns, String> {
    let column = |place: usize| -> Vec<f64> {
        let cells = rows.iter().filter_map(|row| row.cells.get(place));
        cells.filter_map(|cell| table.style.number(cell)).collect()
    };
    let places = match rows[0].cells.len() {
        0..=2 => [0, 1],
        3 if column(0).windows(2).all(|pair| pair[1] == pair[0] + 1.0) => [1, 2],
        3 if column(2).windows(2).all(|pair| pair[1] == pair[0]) => [0, 1],
        found => {
            return Err(format!(
                "there are {found} numbers in a line, and no names of the columns: write x and y alone, or a first line with `x` and `y`; if \
                 commas are decimal signs, write semicolons between the numbers"
            ));
        }
    };
    Ok(CoordinateColumns { places, unit: 1.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<Vec<[f64; 2]>, (u64, String)> {
        points(text)
    }

    #[test]
    fn points_are_read_as_programs_write_them() {
        for text in [
            "0,0.5\n20,0\n20,10\n",
            "0;0,5\n20;0\n20;10\n",
            "\nWing 12\n 0.0000   0.5000\n 20.0 0.0\n 20.0 10.0\n",
            "X;Y\n0;0,5\n20;0\n20;10\n",
            "x_mm\ty_mm\n0\t0.5\n20\t0\n20\t10\n",
            "\"X (cm)\",\"Y (cm)\"\n0,0.05\n2,0\n2,1\n",
            "y/mm,x/mm\n0.5,0\n0,20\n10,20\n",
            "1,0,0.5\n2,20,0\n3,20,10\n",
            "0,0.5,0\n20,0,0\n20,10,0\n",
            "n,x,y,z\n7,0,0.5,3\n8,20,0,4\n9,20,10,5\n",
            "# mine\n0 , 0.5 # left\n20,0\n20,10\n",
            "x,y\n\"0\",\"0.5\"\n20,0\n20,10\n",
        ] {
            let found = of(text).unwrap();
            assert_eq!(found, [[0.0, 0.5], [20.0, 0.0], [20.0, 10.0]], "{text}");
        }
    }

    #[test]
    fn blocks_are_joined_where_their_ends_meet() {
        let (upper, lower) = ("0 0\n1 2\n6 3\n20 0\n", "0 0\n1 -1\n20 0\n");
        for text in [
            format!("Wing 12\n4. 3.\n\n {upper}\n {lower}"),
            format!("4 3\n{upper}{lower}"),
            format!("4 3\n{upper}{}", lower.replacen("0 0", "0 -0.0", 1)),
            format!("{upper}\n\n{lower}"),
            format!("{upper}\n{lower}").replace(' ', ","),
            format!("{upper} \n{lower}").replace(' ', ";"),
            "# x\n7\n0 0\n1 2\n6 3\n20 0\n1 -1\n0 0\n0 0\n".to_owned(),
            "0 0\n\n1 2\n\n6 3\n\n20 0\n\n1 -1\n".to_owned(),
        ] {
            let area = design::geometry::polygon::area(&of(&text).unwrap()).abs();
            assert_eq!(area, 44.5, "{text}");
        }
        let two = "0,0\n9,0\n9,9\n\n1,1\n2,1\n2,2\n";
        for (text, line, part) in [
            (two.to_owned(), 4, "there are 2, #1 9 x 9 at (0, 0), #2 1 x 1 at (1, 1)"),
            (two.replace(',', " "), 5, "begins another outline"),
            (two.replace("\n\n", "\n;\n").replace(',', ";"), 5, "begins another outline"),
            ("5 5\n\n0 0\n9 0\n9 9\n".into(), 1, "stands alone"),
        ] {
            let (found, what) = of(&text).unwrap_err();
            assert!(what.contains(part), "{text}: {what}");
            assert_eq!(found, line, "{text}: {what}");
        }
    }

    #[test]
    fn what_is_no_point_is_shown_with_its_line() {
        for (text, line, part) in [
            ("0,0\n1;2\n3,4\n", 2, "`1;2` is no point"),
            ("0,0\n1\u{200b}0,2\n3,4\n", 2, "`1\\u{200b}0  2`"),
            ("0,0\n1,2\n3\n", 3, "`3` is no point"),
            ("0,0\n1,x\n3,4\n", 2, "`1  x`"),
            ("0,5,0,25\n1,5,0,25\n1,5,9,75\n", 1, "write semicolons"),
            ("0,0,1\n1,2,5\n3,4,4\n", 1, "there are 3 numbers"),
            ("O.5,1\n0,0\n1,2\n", 1, "`O.5  1` is no point"),
            ("a,b\n0,0\n1,2\n", 1, "`a, b` names no columns"),
            ("x (ft),y (ft)\n0,0\n1,2\n", 1, "`ft` is no unit"),
        ] {
            let (found, what) = of(text).unwrap_err();
            assert_eq!(found, line, "{text}: {what}");
            assert!(what.contains(part), "{text}: {what}");
        }
    }
}
