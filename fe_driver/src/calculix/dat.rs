//! Reader of CalculiX .dat files: the printed output of each converged increment.
//!
//! A block is a heading that ends with the time (lambda), a blank line, and rows. A solver that was
//! terminated leaves an incomplete last block: an unterminated line and an incomplete last frame
//! are dropped. Any input gives either frames or an error that names the line.

use support::{Fault, fault};

/// The numbers of rows that a complete increment prints.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    /// Nodes of the mesh.
    pub nodes: usize,
    /// Nodes of arc B.
    pub arc_nodes: usize,
    /// Nodes whose displacements are printed; they are the first of the mesh.
    pub displaced_nodes: usize,
    /// Elements of the mesh.
    pub elements: usize,
    /// Gauss points per element.
    pub points: usize,
}

/// The printed output of one converged increment.
#[derive(Debug, Default, PartialEq)]
pub struct OutputFrame {
    /// Total time: the fraction of the path.
    pub lambda: f64,
    /// Total internal energy: stored plus dissipated (N mm).
    pub energy: f64,
    /// Nodes of arc B, counted from 0, with their reaction forces (N).
    pub reactions: Vec<(usize, [f64; 3])>,
    /// Displacements (mm) of the first nodes of the mesh: the nodes of the lower face, or all.
    pub displacements: Vec<[f64; 3]>,
    /// Equivalent plastic strain at the Gauss points, element by element.
    pub peeq: Vec<f64>,
    /// Cauchy stress (xx, yy, zz, xy, xz, yz) at the Gauss points (MPa), element by element.
    pub stress: Vec<[f64; 6]>,
    energies: usize,
}

/// What the rows of a block are.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Block {
    /// Total internal energy of a set of elements.
    Energy,
    /// Total kinetic energy of a set of elements.
    KineticEnergy,
    /// Forces at the nodes of a set.
    Reactions,
    /// Sum of the forces at the nodes of a set.
    TotalForce,
    /// Displacements of the nodes of a set.
    Displacements,
    /// Equivalent plastic strain at Gauss points.
    PlasticStrain,
    /// Stress at Gauss points.
    Stress,
}

/// The headings that ccx writes, up to the name of the set.
const HEADINGS: [(&str, Block); 7] = [
    ("total internal energy for set", Block::Energy),
    ("total kinetic energy for set", Block::KineticEnergy),
    ("total force (fx,fy,fz) for set", Block::TotalForce),
    ("forces (fx,fy,fz) for set", Block::Reactions),
    ("displacements (vx,vy,vz) for set", Block::Displacements),
    ("equivalent plastic strain (elem, integ.pnt.,pe)for set", Block::PlasticStrain),
    ("stresses (elem, integ.pnt.,sxx,syy,szz,sxy,sxz,syz) for set", Block::Stress),
];

/// The printed output of one increment of some kind of problem.
pub(crate) trait Printed: Sized {
    /// What a complete increment prints.
    type Layout;
    /// An increment with only its time.
    fn begin(time: f64) -> Self;
    /// Its time.
    fn time(&self) -> f64;
    /// Adds a row of the block of a set; `None` if it does not belong there.
    fn add(
        &mut self,
        block: Block,
        set: &str,
        fields: &[&str],
        layout: &Self::Layout,
    ) -> Option<()>;
    /// Whether nothing is missing.
    fn is_complete(&self, layout: &Self::Layout) -> bool;
}

/// Reads the complete frames of a window, in order of lambda.
pub fn read_dat(bytes: &[u8], layout: Layout) -> Result<Vec<OutputFrame>, Fault> {
    read_printed(bytes, &layout)
}

/// Reads the complete increments, in order of time.
pub(crate) fn read_printed<F: Printed>(bytes: &[u8], layout: &F::Layout) -> Result<Vec<F>, Fault> {
    // An unterminated last line may contain a truncated number.
    let end = bytes.iter().rposition(|b| *b == b'\n').map_or(0, |i| i + 1);
    let text = String::from_utf8_lossy(&bytes[..end]);
    let mut frames: Vec<F> = Vec::new();
    let mut block = None;
    for (number, line) in text.lines().enumerate() {
        let line_error = |what: &str| fault!("the solver's output, line {}: {what}", number + 1);
        let line = line.trim();
        if line.is_empty() {
            continue;
        }
        if let Some((heading, time)) = line.rsplit_once(" and time ") {
            let found = HEADINGS
                .iter()
                .find_map(|(start, kind)| Some((*kind, heading.strip_prefix(start)?.trim())));
            block = Some(found.ok_or_else(|| line_error("unknown heading"))?);
            let time: f64 =
                number_in(time).ok_or_else(|| line_error("the heading has no valid time"))?;
            let last = frames.last().map(Printed::time);
            if last.is_none_or(|last| time > last) {
                frames.push(F::begin(time));
            } else if last != Some(time) {
                return Err(line_error("the time is smaller than in the block before"));
            }
            continue;
        }
        let (Some((block, set)), Some(frame)) = (block, frames.last_mut()) else {
            return Err(line_error("row before the first heading"));
        };
        let fields: Vec<_> = line.split_whitespace().collect();
        frame
            .add(block, set, &fields, layout)
            .ok_or_else(|| line_error("malformed or unexpected row"))?;
    }
    if frames.last().is_some_and(|last| !last.is_complete(layout)) {
        frames.pop();
    }
    match frames.iter().find(|frame| !frame.is_complete(layout)) {
        Some(frame) => Err(fault!(
            "the solver's output is incomplete at lambda = {}, which is not the last increment",
            frame.time()
        )),
        None => Ok(frames),
    }
}

impl Printed for OutputFrame {
    type Layout = Layout;

    fn begin(lambda: f64) -> Self {
        Self { lambda, ..Self::default() }
    }

    fn time(&self) -> f64 {
        self.lambda
    }

    fn add(&mut self, block: Block, _set: &str, fields: &[&str], layout: &Layout) -> Option<()> {
        match block {
            Block::Energy => {
                let [energy] = numbers(fields)?;
                self.energy = energy;
                self.energies += 1;
            }
            Block::Reactions => {
                let (node, force) = at_node(fields)?;
                if node >= layout.nodes {
                    return None;
                }
                self.reactions.push((node, force));
            }
            Block::Displacements => {
                let (node, values) = at_node(fields)?;
                if node != self.displacements.len() {
                    return None;
                }
                self.displacements.push(values);
            }
            Block::PlasticStrain => {
                let [peeq] = numbers(in_order(fields, self.peeq.len(), layout)?)?;
                self.peeq.push(peeq);
            }
            Block::Stress => {
                let stress = numbers(in_order(fields, self.stress.len(), layout)?)?;
                self.stress.push(stress);
            }
            Block::KineticEnergy | Block::TotalForce => return None,
        }
        Some(())
    }

    fn is_complete(&self, layout: &Layout) -> bool {
        let points = layout.points * layout.elements;
        self.energies == 1
            && self.reactions.len() == layout.arc_nodes
            && self.displacements.len() == layout.displaced_nodes
            && self.peeq.len() == points
            && self.stress.len() == points
    }
}

/// A node, counted from 0, and the values at it.
pub(crate) fn at_node<const N: usize>(fields: &[&str]) -> Option<(usize, [f64; N])> {
    let (node, values) = fields.split_first()?;
    Some((node.parse::<usize>().ok()?.checked_sub(1)?, numbers(values)?))
}

/// The values of a row, which must belong to Gauss point `index`, counted over all elements.
fn in_order<'a, 't>(fields: &'a [&'t str], index: usize, layout: &Layout) -> Option<&'a [&'t str]> {
    let [element, point, values @ ..] = fields else {
        return None;
    };
    let expected = [index / layout.points + 1, index % layout.points + 1];
    let found: [usize; 2] = [element.parse().ok()?, point.parse().ok()?];
    (index < layout.points * layout.elements && found == expected).then_some(values)
}

/// Exactly N finite numbers.
pub(crate) fn numbers<const N: usize>(fields: &[&str]) -> Option<[f64; N]> {
    let mut values = [0.0; N];
    if fields.len() != N {
        return None;
    }
    for (value, field) in values.iter_mut().zip(fields) {
        *value = number_in(field)?;
    }
    Some(values)
}

/// A finite number. Fortran leaves out the E before an exponent of three digits, as in `1.5-101`.
fn number_in(field: &str) -> Option<f64> {
    let field = field.trim();
    let without_e = || {
        let at = field.rfind(['+', '-']).filter(|at| at + 4 == field.len());
        let (digits, exponent) = field.split_at(at.filter(|at| *at > 0)?);
        format!("{digits}E{exponent}").parse::<f64>().ok()
    };
    let number = field.parse::<f64>().ok().or_else(without_e);
    number.filter(|x| x.is_finite())
}

// Reader of CalculiX .sta files: one line per attempted increment.
//
// The file contains the progress of the solver in a machine-readable form: the lambda reached, the
// number of iterations, and the increments that the output must contain. Reading never fails: a
// line that is not an attempt, or that was truncated, is skipped.

/// One attempted increment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Increment {
    /// Total time (lambda): at the end of the increment if it converged, otherwise at its start.
    pub lambda: f64,
    /// Newton iterations of the attempt.
    pub iterations: usize,
    /// Whether the increment converged.
    pub converged: bool,
}

/// Reads the attempted increments in their order.
pub fn read_sta(bytes: &[u8]) -> Vec<Increment> {
    let end = bytes.iter().rposition(|b| *b == b'\n').map_or(0, |i| i + 1);
    let text = String::from_utf8_lossy(&bytes[..end]);
    text.lines().filter_map(attempt).collect()
}

/// Parses STEP INC ATT ITRS TOT-TIME STEP-TIME INC-TIME; a U after ATT means that the attempt
/// diverged.
fn attempt(line: &str) -> Option<Increment> {
    let fields: Vec<_> = line.split_whitespace().collect();
    let [step, increment, attempt, iterations, lambda, in_step, length] = fields[..] else {
        return None;
    };
    let number = attempt.trim_end_matches('U');
    for count in [step, increment, number] {
        count.parse::<usize>().ok()?;
    }
    let [lambda, ..] = [lambda, in_step, length].map(|time| {
        let time = time.parse::<f64>().ok();
        time.filter(|time| time.is_finite() && *time >= 0.0)
    });
    Some(Increment {
        lambda: lambda?,
        iterations: iterations.parse().ok()?,
        converged: number == attempt,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const LAYOUT: Layout =
        Layout { nodes: 1000, arc_nodes: 2, displaced_nodes: 1, elements: 1, points: 8 };

    /// The output of one increment, as ccx writes it.
    fn printed(lambda: f64) -> String {
        let points = |values: &str| -> String {
            (1..=8).map(|point| format!("         1   {point}{values}\n")).collect()
        };
        format!(
            "\n forces (fx,fy,fz) for set ARCB and time  {lambda:.7E}\n\n\
             \x20        4  1.0E+00 -2.0E+00  3.0E+00\n         7  4.0E+00  5.0E+00  6.0E+00\n\
             \n displacements (vx,vy,vz) for set BOTTOM and time  {lambda:.7E}\n\n\
             \x20        1  0.1E+00  0.2E+00 -0.3E+00\n\
             \n total internal energy for set EALL and time  {lambda:.7E}\n\n  4.25E+01\n\
             \n equivalent plastic strain (elem, integ.pnt.,pe)for set EALL and time  {lambda:.7E}\n\n{}\
             \n stresses (elem, integ.pnt.,sxx,syy,szz,sxy,sxz,syz) for set EALL and time  {lambda:.7E}\n\n{}",
            points("  1.5E-02"),
            points("  1.0 2.0 3.0 4.0 5.0 6.0")
        )
    }

    #[test]
    fn exponents_of_three_digits_are_read_with_and_without_e() {
        for (field, value) in [
            ("-1.5E-101", Some(-1.5e-101)),
            ("-1.5-101", Some(-1.5e-101)),
            ("1.5+101", Some(1.5e101)),
            ("1.5-10", None),
            ("-101", Some(-101.0)),
            ("1.5E+999", None),
            ("1.5+999", None),
        ] {
            assert_eq!(number_in(field), value, "{field}");
        }
    }

    fn two_increments() -> String {
        printed(0.5) + &printed(1.0)
    }

    #[test]
    fn frames_are_read_in_order() {
        let frames = read_dat(two_increments().as_bytes(), LAYOUT).unwrap();
        assert_eq!(frames.iter().map(|f| f.lambda).collect::<Vec<_>>(), [0.5, 1.0]);
        let frame = &frames[1];
        assert_eq!(frame.energy, 42.5);
        assert_eq!(frame.reactions, [(3, [1.0, -2.0, 3.0]), (6, [4.0, 5.0, 6.0])]);
        assert_eq!(frame.displacements, [[0.1, 0.2, -0.3]]);
        assert_eq!(frame.peeq, [0.015; 8]);
        assert_eq!(frame.stress[7], [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(read_dat(b"", LAYOUT).unwrap(), []);
    }

    #[test]
    fn damage_inside_the_output_is_an_error() {
        let missing = two_increments().replacen("         1   8  1.5E-02\n", "", 1);
        let error = read_dat(missing.as_bytes(), LAYOUT).unwrap_err();
        assert!(error.to_string().contains("incomplete at lambda = 0.5"), "{error}");
        for (old, new) in [
            ("4.25E+01", "NaN"),
            // A node that the mesh does not have.
            ("         7  4.0E+00", "      1001  4.0E+00"),
            (" 1   3 ", " 1   4 "),
            // Displacements of another node than the first.
            ("         1  0.1E+00", "         2  0.1E+00"),
            ("total", "mean"),
        ] {
            let damaged = two_increments().replacen(old, new, 1);
            let error = read_dat(damaged.as_bytes(), LAYOUT).unwrap_err();
            assert!(error.to_string().contains(", line "), "{old}: {error}");
        }
    }

    proptest! {
        /// However a killed solver truncated its output, the frames read are complete and correct.
        #[test]
        fn a_truncated_output_gives_its_complete_frames(fraction in 0.0..1.0f64) {
            let text = two_increments();
            let whole = read_dat(text.as_bytes(), LAYOUT).unwrap();
            let cut = (fraction * text.len() as f64) as usize;
            let frames = read_dat(&text.as_bytes()[..cut], LAYOUT).unwrap();
            prop_assert_eq!(&frames[..], &whole[..frames.len()]);
            prop_assert_eq!(frames.len(), usize::from(cut >= printed(0.5).len()));
        }

        /// Lines that may occur in an output, in any order and number.
        #[test]
        fn shuffled_lines_give_complete_frames_or_an_error(
            order in proptest::collection::vec(any::<prop::sample::Index>(), 0..120)
        ) {
            let text = two_increments();
            let lines: Vec<_> = text.split_inclusive('\n').collect();
            let shuffled: String = order.iter().map(|index| *index.get(&lines)).collect();
            if let Ok(frames) = read_dat(shuffled.as_bytes(), LAYOUT) {
                prop_assert!(frames.iter().all(|frame| frame.is_complete(&LAYOUT)));
                prop_assert!(frames.windows(2).all(|pair| pair[0].lambda < pair[1].lambda));
            }
        }

        #[test]
        fn any_bytes_give_frames_or_an_error(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
            if let Ok(frames) = read_dat(&bytes, LAYOUT) {
                prop_assert!(frames.iter().all(|frame| frame.is_complete(&LAYOUT)));
            }
        }

        #[test]
        fn corrupted_bytes_never_panic(at in 0..2000usize, byte in any::<u8>()) {
            let mut bytes = two_increments().into_bytes();
            let at = at % bytes.len();
            bytes[at] = byte;
            let _ = read_dat(&bytes, LAYOUT);
        }
    }
}

#[cfg(test)]
mod sta_tests {
    use super::*;
    use proptest::prelude::*;

    const STATUS: &str = "SUMMARY OF JOB INFORMATION
  STEP      INC     ATT  ITRS     TOT TIME     STEP TIME      INC TIME
     1          1     1U    4  0.000000E+00  0.000000E+00  0.500000E-02
     1          1     2     4  0.125000E-02  0.125000E-02  0.125000E-02
     1          2     1     3  0.250000E-02  0.250000E-02  0.125000E-02
";

    #[test]
    fn attempts_are_read_with_their_outcome() {
        let attempt = |lambda, iterations, converged| Increment { lambda, iterations, converged };
        assert_eq!(
            read_sta(STATUS.as_bytes()),
            [attempt(0.0, 4, false), attempt(0.00125, 4, true), attempt(0.0025, 3, true)]
        );
        assert_eq!(read_sta(b""), []);
    }

    proptest! {
        #[test]
        fn a_truncated_file_gives_its_complete_lines(cut in 0..STATUS.len()) {
            let whole = read_sta(STATUS.as_bytes());
            let attempts = read_sta(&STATUS.as_bytes()[..cut]);
            prop_assert_eq!(&attempts[..], &whole[..attempts.len()]);
        }

        #[test]
        fn any_bytes_are_read(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
            prop_assert!(read_sta(&bytes).iter().all(|attempt| attempt.lambda.is_finite()));
        }
    }
}
