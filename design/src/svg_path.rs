//! The first path of an SVG file as a polygon: lines as they are, Bezier curves flattened.
//!
//! Only the path data (`d`) is read: commands M L H V C S Q T Z, absolute and relative, one closed
//! subpath. Transforms and units are not; the scene says how large the outline is. SVG's y runs
//! downwards and is turned upwards here.

/// Segments of a flattened curve.
const SEGMENTS: usize = 32;

/// Why a file holds no outline; where is a position in the path data.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SvgPathError {
    #[error("there is no <path ... d=\"...\"> in it")]
    NoPath,
    #[error(
        "the command `{command}` at position {position} of the path data is not read; use M L H V C S Q T Z"
    )]
    Command { command: char, position: usize },
    #[error("a number is missing or wrong at position {position} of the path data")]
    Number { position: usize },
    #[error(
        "the path data has a second subpath at position {position}: an outline is one closed curve"
    )]
    SecondSubpath { position: usize },
}

/// The vertices of the first path in an SVG text, y upwards.
pub(crate) fn vertices(svg: &str) -> Result<Vec<[f64; 2]>, SvgPathError> {
    let mut pen = Pen::default();
    let mut data = Data::new(path_data(svg).ok_or(SvgPathError::NoPath)?);
    let mut command = None;
    while let Some(next) = data.command_or(command)? {
        pen.draw(next, &mut data)?;
        // Pairs that follow a move are lines.
        command = match next {
            'M' => Some('L'),
            'm' => Some('l'),
            'Z' | 'z' => None,
            other => Some(other),
        };
    }
    Ok(pen.points.iter().map(|[x, y]| [*x, -y]).collect())
}

/// The value of the attribute d of the first path element.
fn path_data(svg: &str) -> Option<&str> {
    let element = &svg[svg.find("<path")?..];
    let element = &element[..element.find('>')?];
    let start = element.match_indices("d=").find(|(at, _)| {
        let before = element[..*at].chars().next_back();
        before.is_some_and(char::is_whitespace)
    });
    let value = &element[start?.0 + 2..];
    let quote = value.chars().next().filter(|c| ['"', '\''].contains(c))?;
    value[1..].split(quote).next()
}

/// Path data read from left to right.
struct Data<'a> {
    text: &'a str,
    position: usize,
}

impl<'a> Data<'a> {
    fn new(text: &'a str) -> Self {
        Self { text, position: 0 }
    }

    fn rest(&mut self) -> &'a str {
        let rest = &self.text[self.position..];
        let trimmed = rest.trim_start_matches(|c: char| c.is_ascii_whitespace() || c == ',');
        self.position += rest.len() - trimmed.len();
        trimmed
    }

    /// The next command; `repeated` where numbers follow without one. `None` at the end.
    fn command_or(&mut self, repeated: Option<char>) -> Result<Option<char>, SvgPathError> {
        let Some(next) = self.rest().chars().next() else {
            return Ok(None);
        };
        if next.is_alphabetic() {
            self.position += next.len_utf8();
            return Ok(Some(next));
        }
        let position = self.position;
        let command = repeated.ok_or(SvgPathError::Number { position })?;
        Ok(Some(command))
    }

    fn number(&mut self) -> Result<f64, SvgPathError> {
        let rest = self.rest();
        let mut length = 0;
        let (mut point, mut exponent) = (false, false);
        for (at, c) in rest.char_indices() {
            let signed = at == 0 || rest[..at].ends_with(['e', 'E']);
            match c {
                '0'..='9' => {}
                '+' | '-' if signed => {}
                '.' if !point && !exponent => point = true,
                'e' | 'E' if !exponent && at > 0 => exponent = true,
                _ => break,
            }
            length = at + 1;
        }
        let position = self.position;
        let number = rest[..length].parse::<f64>().ok();
        self.position += length;
        number
            .filter(|number| number.is_finite())
            .ok_or(SvgPathError::Number { position })
    }

    fn point(&mut self, origin: [f64; 2]) -> Result<[f64; 2], SvgPathError> {
        Ok([origin[0] + self.number()?, origin[1] + self.number()?])
    }
}

/// The polygon drawn so far.
#[derive(Default)]
struct Pen {
    points: Vec<[f64; 2]>,
    at: [f64; 2],
    /// The last control point of a curve that a smooth one may continue, and its degree.
    control: Option<([f64; 2], usize)>,
}

impl Pen {
    fn draw(&mut self, command: char, data: &mut Data) -> Result<(), SvgPathError> {
        let position = data.position;
        let origin = if command.is_lowercase() {
            self.at
        } else {
            [0.0; 2]
        };
        let at = self.at;
        match command.to_ascii_uppercase() {
            'M' if !self.points.is_empty() => return Err(SvgPathError::SecondSubpath { position }),
            'M' | 'L' => self.line(data.point(origin)?),
            'H' => self.line([origin[0] + data.number()?, at[1]]),
            'V' => self.line([at[0], origin[1] + data.number()?]),
            'C' => {
                let (b, c) = (data.point(origin)?, data.point(origin)?);
                self.curve(&[at, b, c, data.point(origin)?]);
            }
            'S' => {
                let (b, c) = (self.reflected(3), data.point(origin)?);
                self.curve(&[at, b, c, data.point(origin)?]);
            }
            'Q' => {
                let b = data.point(origin)?;
                self.curve(&[at, b, data.point(origin)?]);
            }
            'T' => {
                let b = self.reflected(2);
                self.curve(&[at, b, data.point(origin)?]);
            }
            'Z' => {}
            _ => return Err(SvgPathError::Command { command, position }),
        }
        Ok(())
    }

    fn line(&mut self, to: [f64; 2]) {
        self.points.push(to);
        (self.at, self.control) = (to, None);
    }

    /// A Bezier curve of any degree, by de Casteljau's algorithm.
    fn curve(&mut self, controls: &[[f64; 2]]) {
        for i in 1..=SEGMENTS {
            let t = i as f64 / SEGMENTS as f64;
            let mut points = controls.to_vec();
            while points.len() > 1 {
                points = (points.windows(2))
                    .map(|pair| [0, 1].map(|c| (1.0 - t) * pair[0][c] + t * pair[1][c]))
                    .collect();
            }
            self.points.push(points[0]);
        }
        let degree = controls.len() - 1;
        (self.at, self.control) = (controls[degree], Some((controls[degree - 1], degree)));
    }

    /// The control point that continues the last curve smoothly.
    fn reflected(&self, degree: usize) -> [f64; 2] {
        match self.control {
            Some((control, same)) if same == degree => {
                [0, 1].map(|c| 2.0 * self.at[c] - control[c])
            }
            _ => self.at,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(data: &str) -> Result<Vec<[f64; 2]>, SvgPathError> {
        vertices(&format!(
            "<svg><path id=\"x\" d=\"{data}\" fill='none'/></svg>"
        ))
    }

    #[test]
    fn lines_absolute_relative_and_repeated() {
        let square = [[0.0, 0.0], [10.0, 0.0], [10.0, -10.0], [0.0, -10.0]];
        for data in [
            "M0 0 L10 0 L10 10 L0 10 Z",
            "m0,0 10,0 0,10 -10,0z",
            "M0 0H10V10H0Z",
            "M0 0h1e1v10-0h-10",
        ] {
            let found = of(data);
            let found = found.unwrap_or_else(|error| panic!("{data}: {error}"));
            assert_eq!(found.first(), square.first(), "{data}");
            assert_eq!(found.last(), square.last(), "{data}");
        }
    }

    #[test]
    fn a_circle_of_four_cubics_has_its_area() {
        let k = 0.552_284_75;
        let data = format!("M1 0 C1 {k} {k} 1 0 1 S-1 {k} -1 0 S-{k} -1 0 -1 S1 -{k} 1 0Z");
        let area = crate::polygon::area(&of(&data).unwrap()).abs();
        assert!((area - std::f64::consts::PI).abs() < 5e-3, "{area}");
    }

    #[test]
    fn what_is_no_outline_is_named() {
        assert_eq!(vertices("<svg/>"), Err(SvgPathError::NoPath));
        let arc = of("M0 0 A1 1 0 0 0 2 2").unwrap_err();
        assert!(arc.to_string().contains("`A` at position"), "{arc}");
        assert!(matches!(of("M0 0 L x"), Err(SvgPathError::Number { .. })));
        let two = of("M0 0 L1 0 L1 1 Z M5 5 L6 6");
        assert!(matches!(two, Err(SvgPathError::SecondSubpath { .. })));
    }
}
