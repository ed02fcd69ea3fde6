//! `kirigami-studies trust`: the error of a surrogate's forces, and the ensemble as an estimate of it.

use crate::charts::{self, Calibration};
use ::train::{Disagreement, EnsembleCheck, Parity, TrainingConfig, disagreements};
use anyhow::{Result, ensure};
use clap::Args;
use dataset::{Database, Part, Row};
use hinge::TrainingDomain;
use kirigami::commands::train::kept_fit;
use kirigami::ui::{picture, run_folder};
use std::fmt::Write;
use std::path::PathBuf;
use surrogate::{Surrogate, TestErrors, number_or_dash};

/// Measure the spread over seeds, the ensemble's deviation as an error estimate, and errors outside the domain
///
/// Trains networks of several seeds on the database, and as many on the states within a smaller
/// domain, which are then evaluated outside it. Writes trust.csv, trust.md, tradeoff.md
/// and a chart. Example: kirigami-studies trust data/hinges.parquet --seeds 2
#[derive(Args)]
pub struct TrustStudy {
    /// Database (Parquet with its manifest)
    #[arg(value_name = "DATABASE")]
    database: PathBuf,
    /// Training configuration (TOML)
    #[arg(
        long,
        value_name = "FILE",
        default_value = "configs/training/medium.toml"
    )]
    config: PathBuf,
    /// Number of networks in each ensemble, at least two
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u64).range(2..=64))]
    seeds: u64,
    /// Folder for the tables, the chart and the networks
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-trust")]
    out: PathBuf,
}

/// Size of the smaller domain relative to the whole, about the undeformed state, or from the middle of the
/// designs.
const KEPT: f64 = 0.75;

/// Bins of the distance outside, relative to the distance from the centre to the edge; the first bin is inside.
const OUTSIDE: [f64; 4] = [0.0, 0.05, 0.15, f64::INFINITY];

/// An ensemble with its predictions for some rows.
struct Answers {
    members: Vec<Surrogate>,
    rows: Vec<Row>,
    forces: Vec<Disagreement>,
    /// The parity data of each member.
    parities: Vec<Parity>,
}

impl TrustStudy {
    pub fn run(&self) -> Result<()> {
        let config: TrainingConfig = support::toml_file::read(&self.config)?;
        let database = Database::read(&self.database)?;
        let _held = run_folder::hold(&self.out)?;
        let smaller = smaller(&database.manifest().domain);
        let within = database.within(&smaller)?;
        let test = database.part(Part::Test);
        let whole = self.answers("whole", &config, &database, test.clone())?;
        let inner = self.answers("inner", &config, &within, test)?;
        self.write(&whole, &inner)?;
        println!("see {}", self.out.join("trust.md").display());
        Ok(())
    }

    fn answers(
        &self,
        name: &str,
        config: &TrainingConfig,
        database: &Database,
        rows: Vec<Row>,
    ) -> Result<Answers> {
        let member = |seed: u64| {
            eprintln!("{name} domain, network {} of {}", seed + 1, self.seeds);
            let config = TrainingConfig {
                seed,
                ..config.clone()
            };
            let name = format!("{name}-{seed}");
            kept_fit(&self.out.join("fits"), &name, database, &config, None)
        };
        let members: Vec<Surrogate> = (0..self.seeds).map(member).collect::<Result<_>>()?;
        ensure!(!rows.is_empty(), "the database has no rows to test with");
        Ok(Answers {
            forces: disagreements(&members, &rows),
            parities: members.iter().map(|it| Parity::of(it, &rows)).collect(),
            members,
            rows,
        })
    }

    fn write(&self, whole: &Answers, inner: &Answers) -> Result<()> {
        let tenths = whole.tenths();
        let mut page = "# How far a surrogate can be trusted\n\nErrors on geometries that no network was trained \
                        on.\n\n## Networks of several seeds\n\n"
            .to_owned();
        page += &whole.spread()?;
        page += "\n## The ensemble's deviation as an estimate of its error\n\n";
        page += &whole.calibration(&tenths)?;
        page += "\n## Outside the domain\n\n";
        page += &inner.outside()?;
        let write = |name: &str, text: &str| run_folder::write(&self.out, name, text);
        write("trust.md", &page)?;
        write("trust.csv", &inner.csv(whole)?)?;
        write("tradeoff.md", &whole.tradeoff()?)?;
        let outside = inner.by_distance();
        let chart = charts::calibration(&[
            Calibration {
                title: "inside the domain, tenths by deviation",
                points: &tenths,
            },
            Calibration {
                title: "outside the domain, by distance",
                points: &outside
                    .iter()
                    .map(|(.., of)| [of.deviation, of.error])
                    .collect::<Vec<_>>(),
            },
        ])?;
        picture::save(&chart, &self.out.join("trust"), 1600)?;
        Ok(())
    }
}

/// The domain scaled by [`KEPT`] in each state variable and interval. The upper end of the solved cut angles is the
/// right angle, beyond which all hinges are mirror images; it is not changed.
fn smaller(domain: &TrainingDomain) -> TrainingDomain {
    let [narrow, wide] = domain.w_lig;
    let [acute, right] = domain.alpha;
    let margin = 0.5 * (1.0 - KEPT) * (wide - narrow);
    let mut smaller = domain.scaled_by(KEPT);
    smaller.w_lig = [narrow + margin, wide - margin];
    smaller.alpha = [right - KEPT * (right - acute), right];
    smaller
}

impl Answers {
    /// The errors of each network, and of the mean of their predictions.
    fn spread(&self) -> Result<String> {
        let mut text =
            "| network | W | F_a | F_s | M | D | D_peak | worst bin of theta or w_lig, W \
                        |\n|---|---|---|---|---|---|---|---|\n"
                .to_owned();
        let mut line = |name: &str, errors: &TestErrors, worst: Option<f64>| {
            let [w, f_a, f_s, m, ..] = errors.percents();
            let [.., d, peak] = errors.percents().map(|error| number_or_dash(error, 1));
            let worst = worst.map_or(String::new(), |worst| format!("{worst:.2} %"));
            writeln!(
                text,
                "| {name} | {w:.2} % | {f_a:.1} % | {f_s:.1} % | {m:.1} % | {d} % | {peak} % \
                 | {worst} |"
            )
        };
        for (seed, (member, parity)) in self.members.iter().zip(&self.parities).enumerate() {
            let worst = worst_bin(member);
            line(&format!("seed {seed}"), &parity.errors(), Some(worst))?;
        }
        line("mean of all", &Parity::mean(&self.parities).errors(), None)?;
        Ok(text)
    }

    /// Deviation and error of the forces, each a root mean square: of the tenth of the states
    /// with the smallest deviation, of the next tenth, and so on.
    fn tenths(&self) -> Vec<[f64; 2]> {
        let mut sorted = self.forces.clone();
        sorted.sort_by(|x, y| x.deviation.total_cmp(&y.deviation));
        sorted
            .chunks(sorted.len().div_ceil(10))
            .map(|states| {
                let EnsembleCheck {
                    deviation, error, ..
                } = EnsembleCheck::of(states);
                [deviation, error]
            })
            .collect()
    }

    fn calibration(&self, tenths: &[[f64; 2]]) -> Result<String> {
        let check = EnsembleCheck::of(&self.forces);
        let mut text = format!(
            "Forces are in units of their root mean square; values are means over the three. Over all states the \
             deviation of the networks is {:.4} and the error of their mean {:.4}: the error is {:.1} times the \
             deviation. The tenth of the states with the largest deviation has {:.0} % of the squared error. The \
             logarithms of the two have a correlation of {:.2}.\n\n\
             | tenth | deviation | error | error / deviation |\n|---|---|---|---|\n",
            check.deviation,
            check.error,
            check.error / check.deviation,
            100.0 * check.error_in_top_tenth,
            check.correlation
        );
        for (tenth, [deviation, error]) in tenths.iter().enumerate() {
            let ratio = error / deviation;
            let tenth = tenth + 1;
            writeln!(
                text,
                "| {tenth} | {deviation:.5} | {error:.5} | {ratio:.1} |"
            )?;
        }
        text += "\n![deviation and error](trust.png)\n";
        Ok(text)
    }

    /// The rows by their distance outside the domain of these networks: name of the bin, rows, check.
    fn by_distance(&self) -> Vec<(String, Vec<usize>, EnsembleCheck)> {
        let distance = |row: &Row| {
            let domain = self.members[0].domain();
            (-domain.depth(&row.design, &row.sample.deformation())).max(0.0)
        };
        let distances: Vec<f64> = self.rows.iter().map(distance).collect();
        let lower = std::iter::once(-1.0).chain(OUTSIDE);
        let bins = lower.zip(OUTSIDE).map(|(lower, upper)| {
            let name = match upper {
                0.0 => "inside".into(),
                f64::INFINITY => format!("over {:.0} %", 100.0 * lower),
                _ => format!("{:.0} to {:.0} %", 100.0 * lower, 100.0 * upper),
            };
            let inside = |&row: &usize| lower < distances[row] && distances[row] <= upper;
            (name, (0..distances.len()).filter(inside).collect())
        });
        let bins = bins.filter(|(_, rows): &(_, Vec<usize>)| !rows.is_empty());
        bins.map(|(name, rows)| {
            let states: Vec<Disagreement> = rows.iter().map(|&row| self.forces[row]).collect();
            (name, rows, EnsembleCheck::of(&states))
        })
        .collect()
    }

    fn outside(&self) -> Result<String> {
        let mut text = format!(
            "Networks trained within {:.0} % of the domain, evaluated on all states of the test \
             geometries. Distances outside are from the edge of the smaller domain, relative to that from \
             its centre to the edge. Errors are those of the networks' mean, root mean \
             squares relative to the states of the bin (W) and to all states (forces). A few states with \
             large forces near the edge of the smaller domain can dominate them; the error of the median state \
             is therefore given too.\n\n\
             | outside | states | W | forces, error | median state | forces, deviation |\n\
             |---|---|---|---|---|---|\n",
            100.0 * KEPT
        );
        for (name, rows, check) in self.by_distance() {
            let of_bin: Vec<Row> = rows.iter().map(|&row| self.rows[row].clone()).collect();
            let parities: Vec<Parity> = self
                .members
                .iter()
                .map(|it| Parity::of(it, &of_bin))
                .collect();
            let [energy, ..] = Parity::mean(&parities).errors().percents();
            let mut errors: Vec<f64> = rows.iter().map(|&row| self.forces[row].error).collect();
            errors.sort_by(f64::total_cmp);
            writeln!(
                text,
                "| {name} | {} | {energy:.2} % | {:.2} % | {:.2} % | {:.2} % |",
                rows.len(),
                100.0 * check.error,
                100.0 * errors[errors.len() / 2],
                100.0 * check.deviation
            )?;
        }
        text += "\nThe report of a design states the fraction of its hinge states inside the domain; outside, a convex \
                 term keeps the energy coercive.\n";
        Ok(text)
    }

    /// Every test state: distance outside the smaller domain, and deviation and error of the
    /// forces for the networks of that domain and of the whole one.
    fn csv(&self, whole: &Answers) -> Result<String> {
        let mut text = "w_lig_mm,alpha_deg,eta_a,eta_s,theta_deg,depth_in_smaller_domain,\
            deviation_smaller,error_smaller,deviation_whole,error_whole\n"
            .to_owned();
        let domain = self.members[0].domain();
        let states = self.rows.iter().zip(&self.forces).zip(&whole.forces);
        for ((row, inner), whole) in states {
            let deformation = row.sample.deformation();
            let [eta_a, eta_s] = row.eta();
            writeln!(
                text,
                "{:.4},{:.3},{eta_a:.5},{eta_s:.5},{:.3},{:.4},{:.4e},{:.4e},{:.4e},{:.4e}",
                row.design.w_lig,
                row.design.alpha.to_degrees(),
                deformation.theta.to_degrees(),
                domain.depth(&row.design, &deformation),
                inner.deviation,
                inner.error,
                whole.deviation,
                whole.error
            )?;
        }
        Ok(text)
    }

    fn tradeoff(&self) -> Result<String> {
        let count = self.members.len();
        let rms = |quantity: usize| {
            let squares = self
                .parities
                .iter()
                .map(|it| it.errors().percents()[quantity].powi(2));
            (squares.sum::<f64>() / count as f64).sqrt()
        };
        let mean = Parity::mean(&self.parities).errors().percents();
        let mut text =
            "## Ensemble\n\n| networks | evaluations | W | F_a | F_s | M | D | good for \
                        |\n|---|---|---|---|---|---|---|---|\n"
                .to_owned();
        let mut line = |networks: usize, errors: [f64; 5], what: &str| {
            let [w, f_a, f_s, m, d] = errors;
            let d = number_or_dash(d, 1);
            writeln!(
                text,
                "| {networks} | {networks} | {w:.2} % | {f_a:.1} % | {f_s:.1} % | {m:.1} % | \
                 {d} % | {what} |"
            )
        };
        line(1, std::array::from_fn(rms), "design")?;
        line(
            count,
            std::array::from_fn(|k| mean[k]),
            "an estimate of error; the last digit",
        )?;
        Ok(text)
    }
}

/// Maximum error of W in any bin of rotation or of ligament width (%).
fn worst_bin(surrogate: &Surrogate) -> f64 {
    let bins = surrogate.card().error_bins.iter();
    bins.filter(|bin| ["theta_deg", "w_lig"].contains(&bin.quantity.as_str()))
        .map(|bin| 100.0 * bin.errors.energy.relative_rmse)
        .fold(0.0, f64::max)
}
