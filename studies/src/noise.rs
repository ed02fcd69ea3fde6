//! `kirigami-studies noise`: the part of the data that no surrogate can learn, because each window has its own mesh.
//!
//! Along a line of neighbouring hinges every quantity is smooth. The residual of a parabola fitted to
//! five of them is the noise of their meshes,
//!
//! ```text
//! y_k = c_0 + c_1 k + c_2 k^2 + e_k,   k = -2 ... 2,     noise^2 = mean over states of sum e_k^2 / (5 - 3)
//! ```

use anyhow::{Result, ensure};
use clap::Args;
use fe_driver::{DeformationPath, KeptSolve};
use hinge::{HingeConstants, HingeDeformation, HingeSample, SheetMaterial};
use kirigami::replays::kept_solves::{Outcome, SolveArgs};
use kirigami::replays::routes::window;
use kirigami::ui::run_folder;
use mesher::{Imperfection, MeshRecipe, Tier};
use std::f64::consts::PI;
use std::path::PathBuf;

/// Measure the noise of the window meshes on neighbouring hinges and mirrored pairs
///
/// Four rays are solved with five close ligament widths, with five close cut angles, and
/// with the mirror image; the ray in tension also with other imperfections. Writes noise.csv and noise.md. Example: kirigami-studies noise --tier tiny
#[derive(Args)]
pub struct NoiseStudy {
    /// Sheet material (TOML)
    #[arg(
        long,
        value_name = "FILE",
        default_value = "configs/materials/pet-0.5mm.toml"
    )]
    material: PathBuf,
    /// Mesh tier of the windows
    #[arg(long, value_name = "TIER", default_value_t = Tier::Default)]
    tier: Tier,
    /// Folder for the tables and the solutions
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-noise")]
    out: PathBuf,
    #[command(flatten)]
    solve: SolveArgs,
}

/// w_lig (mm), alpha (deg), and the end of the ray: eta_a, eta_s, theta (deg).
const RAYS: [[f64; 5]; 4] = [
    [5.5, 85.0, -0.12, 0.08, 60.0],
    [11.0, 60.0, 0.04, -0.15, 45.0],
    [20.0, 75.0, -0.2, 0.05, 50.0],
    TENSION,
];

/// A wide ligament that is stretched while it rotates. It buckles a second time, earlier or later.
const TENSION: [f64; 5] = [24.0, 80.0, 0.22, 0.0, 60.0];

/// Imperfections of the ray in tension: amplitude over t, and half-widths over w_lig.
const IMPERFECTIONS: [Imperfection; 6] = [
    imperfection(0.25, [1.0, 1.0]),
    imperfection(0.5, [1.0, 1.0]),
    imperfection(1.0, [1.0, 1.0]),
    imperfection(2.0, [1.0, 1.0]),
    imperfection(1.0, [0.5, 0.5]),
    imperfection(1.0, [2.0, 1.4]),
];

const fn imperfection(amplitude: f64, widths: [f64; 2]) -> Imperfection {
    Imperfection { amplitude, widths }
}

/// Steps between neighbours: of the logarithm of w_lig, and of alpha (rad).
const STEPS: [f64; 2] = [0.005, 0.005];

/// Number of equidistant states of the ray that are compared.
const STATES: usize = 20;

const QUANTITIES: [&str; 6] = ["W", "F_a", "F_s", "M_theta", "D", "D_peak"];

/// A neighbour of the hinge of a ray: k steps in log w_lig or in alpha, or the mirror image.
#[derive(Clone, Copy, PartialEq)]
enum Neighbour {
    Wider(f64),
    Blunter(f64),
    Mirrored,
}

impl NoiseStudy {
    pub fn run(&self) -> Result<()> {
        let material = SheetMaterial::load(&self.material)?;
        let _held = run_folder::hold(&self.out)?;
        let beside = neighbours();
        let window = |ray: &[f64; 5], neighbour: &Neighbour, imperfection| {
            neighbour.window(ray, &material, self.tier, imperfection)
        };
        let usual = RAYS.iter().flat_map(|ray| {
            let usual = Imperfection::default();
            beside
                .iter()
                .map(move |neighbour| window(ray, neighbour, usual))
        });
        let wider = &beside[..5];
        let imperfect = IMPERFECTIONS.iter().flat_map(|imperfection| {
            wider
                .iter()
                .map(move |neighbour| window(&TENSION, neighbour, *imperfection))
        });
        let solves: Vec<KeptSolve> = usual.chain(imperfect).collect();
        let outcomes = self
            .solve
            .solve(&solves.iter().collect::<Vec<_>>(), &self.out)?;
        let (usual, imperfect) = outcomes.split_at(RAYS.len() * beside.len());
        let mut table = NoiseTable::new();
        for (ray, outcomes) in RAYS.iter().zip(usual.chunks(beside.len())) {
            let [w_lig, alpha_deg, ..] = *ray;
            let name = format!("{w_lig} mm, {alpha_deg} deg");
            let rays = match solved(outcomes) {
                Ok(rays) => rays,
                Err(reason) => {
                    table.gap(&name, &reason);
                    continue;
                }
            };
            let angles = [&rays[5..7], &rays[2..3], &rays[7..9]].concat();
            for (line, noise) in [
                ("width", scatter(&rays[..5])),
                ("angle", scatter(&angles)),
                ("mirror", difference(&rays[2], &rays[9])),
            ] {
                table.row(&name, line, noise);
            }
        }
        let usual = std::mem::replace(&mut table.markdown, NoiseTable::heading());
        for (imperfection, outcomes) in IMPERFECTIONS.iter().zip(imperfect.chunks(wider.len())) {
            let Imperfection {
                amplitude,
                widths: [x, y],
            } = imperfection;
            let name = format!("{amplitude} t, {x} x {y}");
            match solved(outcomes) {
                Ok(rays) => table.row(&name, "width", scatter(&rays)),
                Err(reason) => table.gap(&name, &reason),
            }
        }
        let [w_lig, alpha_deg, eta_a, ..] = TENSION;
        let page = format!(
            "# Noise of the meshes\n\nTier {}. Five hinges, each with a ligament {} % wider than the one before; five \
             hinges whose cut angles are {} rad apart; and a mirrored pair. The noise is the residual of a parabola \
             (for the pair: the difference divided by the square root of two), as a root mean square over the ray, \
             relative to that of the quantity.\n\n{usual}\n## Imperfection of a ligament in tension\n\nThe ray of \
             {w_lig} mm and {alpha_deg} deg is stretched to eta_a = {eta_a} while it rotates. The imperfection is named \
             by its amplitude over the thickness, and its half-widths over w_lig; the usual one is 1 t, 1 x 1.\n\n{}",
            self.tier,
            100.0 * STEPS[0],
            STEPS[1],
            table.markdown
        );
        let csv = table.csv;
        run_folder::write(&self.out, "noise.csv", &csv)?;
        run_folder::write(&self.out, "noise.md", &page)?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }
}

/// The noise of lines of neighbours, as CSV and as a table of a page.
struct NoiseTable {
    csv: String,
    markdown: String,
}

impl NoiseTable {
    fn new() -> Self {
        Self {
            csv: "ray,line,quantity,noise_percent\n".to_owned(),
            markdown: Self::heading(),
        }
    }

    fn heading() -> String {
        let names = QUANTITIES.join(" | ");
        let rule = "---|".repeat(QUANTITIES.len());
        format!("| ray | line | {names} |\n|---|---|{rule}\n")
    }

    /// A ray whose neighbours were not all solved.
    fn gap(&mut self, ray: &str, reason: &anyhow::Error) {
        // Only the first line: the rest quotes the end of the solver's log.
        let reason = reason.to_string();
        let reason = reason.lines().next().unwrap_or_default();
        self.markdown += &format!("| {ray} | {reason} |{}\n", " - |".repeat(QUANTITIES.len()));
    }

    fn row(&mut self, ray: &str, line: &str, noise: [f64; 6]) {
        let percent = noise.map(|noise| 100.0 * noise);
        let cells = percent.map(|percent| format!("{percent:.3} %")).join(" | ");
        self.markdown += &format!("| {ray} | {line} | {cells} |\n");
        for (quantity, percent) in QUANTITIES.iter().zip(percent) {
            self.csv += &format!("\"{ray}\",{line},{quantity},{percent:.5}\n");
        }
    }
}

/// Five widths, the third being that of the ray; four further angles; and the mirror image.
fn neighbours() -> Vec<Neighbour> {
    let widths = [-2.0, -1.0, 0.0, 1.0, 2.0].map(Neighbour::Wider);
    let angles = [-2.0, -1.0, 1.0, 2.0].map(Neighbour::Blunter);
    [&widths[..], &angles, &[Neighbour::Mirrored]].concat()
}

impl Neighbour {
    fn window(
        self,
        ray: &[f64; 5],
        material: &SheetMaterial,
        tier: Tier,
        imperfection: Imperfection,
    ) -> KeptSolve {
        let [w_lig, alpha_deg, eta_a, eta_s, theta_deg] = *ray;
        let alpha = alpha_deg.to_radians();
        let (w_lig, alpha, eta_s) = match self {
            Self::Wider(k) => (w_lig * (k * STEPS[0]).exp(), alpha, eta_s),
            Self::Blunter(k) => (w_lig, alpha + k * STEPS[1], eta_s),
            Self::Mirrored => (w_lig, PI - alpha, -eta_s),
        };
        let end = HingeDeformation::from_eta(eta_a, eta_s, theta_deg.to_radians(), w_lig);
        let design = HingeConstants::PAPER.hinge(w_lig, alpha);
        KeptSolve {
            recipe: MeshRecipe {
                imperfection,
                ..tier.recipe()
            },
            ..window(design, DeformationPath::straight(end), material, tier)
        }
    }
}

/// The quantities at equidistant states of each ray.
fn solved(outcomes: &[Outcome]) -> Result<Vec<Vec<[f64; 6]>>> {
    let of_ray = |outcome: &Outcome| {
        let solution = match outcome {
            Ok(solution) => solution,
            Err(reason) => anyhow::bail!("one of the neighbouring hinges was not solved: {reason}"),
        };
        let fractions = (1..=STATES).map(|k| k as f64 / STATES as f64);
        let states: Vec<_> = fractions
            .filter_map(|fraction| HingeSample::at(&solution.samples, fraction - 1e-9))
            .map(|x| {
                [
                    x.w,
                    x.f_a,
                    x.f_s,
                    x.m_theta,
                    x.d,
                    x.d_peak.unwrap_or(f64::NAN),
                ]
            })
            .collect();
        ensure!(
            states.len() == STATES,
            "the solve of one of the neighbouring hinges stopped before the end of its ray"
        );
        Ok(states)
    };
    outcomes.iter().map(of_ray).collect()
}

/// Noise of each quantity relative to its root mean square, for a line of five neighbours.
fn scatter(rays: &[Vec<[f64; 6]>]) -> [f64; 6] {
    // Orthogonal to every parabola through five equidistant points.
    const CUBIC: [f64; 5] = [-1.0, 2.0, 0.0, -2.0, 1.0];
    const QUARTIC: [f64; 5] = [1.0, -4.0, 6.0, -4.0, 1.0];
    std::array::from_fn(|quantity| {
        let residual = |i: usize| {
            let along = |shape: [f64; 5]| {
                let terms = shape.iter().zip(rays).map(|(c, ray)| c * ray[i][quantity]);
                let squares: f64 = shape.iter().map(|c| c * c).sum();
                terms.sum::<f64>().powi(2) / squares
            };
            (along(CUBIC) + along(QUARTIC)) / 2.0
        };
        let noise: f64 = (0..STATES).map(residual).sum();
        let values = rays.iter().flatten().map(|state| state[quantity].powi(2));
        let scale = values.sum::<f64>() / rays.len() as f64;
        (noise / scale.max(f64::MIN_POSITIVE)).sqrt()
    })
}

/// The noise of a mirrored pair, whose F_s have opposite signs.
fn difference(ray: &[[f64; 6]], image: &[[f64; 6]]) -> [f64; 6] {
    std::array::from_fn(|quantity| {
        let sign = if QUANTITIES[quantity] == "F_s" {
            -1.0
        } else {
            1.0
        };
        let pairs = ray.iter().zip(image);
        let squares = pairs.map(|(x, y)| (x[quantity] - sign * y[quantity]).powi(2) / 2.0);
        let scale: f64 = ray.iter().map(|x| x[quantity].powi(2)).sum();
        (squares.sum::<f64>() / scale.max(f64::MIN_POSITIVE)).sqrt()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_has_no_noise_and_noise_has_its_own_size() {
        let rays = |noise: f64| -> Vec<Vec<[f64; 6]>> {
            let signs = [1.0, 1.0, -1.0, -1.0, 1.0];
            let ray = |k: usize| {
                let x = k as f64;
                let state = |i: usize| {
                    let sign = if i.is_multiple_of(3) { 1.0 } else { -1.0 };
                    [1.0 + 0.1 * x - 0.03 * x * x + noise * sign * signs[k]; 6]
                };
                (0..STATES).map(state).collect()
            };
            (0..5).map(ray).collect()
        };
        assert!(scatter(&rays(0.0)).iter().all(|noise| *noise < 1e-12));
        // The projection of the signs on the two shapes.
        let along = (-1.0_f64 + 2.0 + 2.0 + 1.0).powi(2) / 10.0
            + (1.0_f64 - 4.0 - 6.0 + 4.0 + 1.0).powi(2) / 70.0;
        let found = scatter(&rays(1e-3))[0];
        let scale = rays(0.0).concat().iter().map(|x| x[0] * x[0]).sum::<f64>();
        let expected = 1e-3 * (along / 2.0 / (scale / (5 * STATES) as f64)).sqrt();
        assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
    }

    #[test]
    fn a_mirrored_pair_differs_by_its_noise_alone() {
        let ray = vec![[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]; STATES];
        let image = vec![[1.0, 2.0, -3.0, 4.0, 5.0, 6.6]; STATES];
        let [.., d, d_peak] = difference(&ray, &image);
        assert_eq!((difference(&ray, &image)[2], d), (0.0, 0.0));
        assert!((d_peak - 0.1 / 2.0_f64.sqrt()).abs() < 1e-12);
    }
}
