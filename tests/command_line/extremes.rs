//! The table of extremes in docs/LIMITS.md: what the shipped plate does far outside of what it was
//! made for. With `KIRIGAMI_WRITE=1` the test writes the table instead.

use design::equilibrium::load_step::Status;
use design::objective::design_problem::Deployment;
use scene::target::TargetShape;
use scene::{Level, Posture, PostureConfig, Scene, SceneConfig};
use std::path::Path;

/// Values of a quantity of the plate, from the smallest to the largest, and how a scene gets them.
struct Sweep {
    quantity: &'static str,
    values: &'static [f64],
    change: fn(&mut SceneConfig, f64),
}

const SWEEPS: [Sweep; 6] = [
    Sweep {
        quantity: "stroke, mm (45.4)",
        values: &[-200.0, -30.0, -3.0, -1e-6, 1e-9, 1e-3, 45.4, 90.0, 120.0, 200.0, 1e3],
        change: |scene, stroke| scene.drive.as_mut().unwrap().stroke = stroke,
    },
    Sweep {
        quantity: "dead load instead of the stroke, N (27)",
        values: &[1e-9, 1e-3, 1.0, 10.0, 27.0, 40.0, 100.0, 1e3, 9e4],
        change: |scene, load| {
            scene.drive = None;
            let force = &mut scene.loads[0].force;
            *force = force.map(|part| load * part);
        },
    },
    Sweep {
        quantity: "ligaments, mm (1.6)",
        values: &[0.51, 0.7, 0.92, 1.6, 2.8, 3.2, 6.0, 20.0],
        change: |scene, width| {
            scene.ligament.start = width;
            scene.ligament.range = [0.99 * width, 1.01 * width].map(|width: f64| width.max(0.5));
        },
    },
    Sweep {
        quantity: "cut angle, deg (90)",
        values: &[8.0, 15.0, 24.0, 30.0, 60.0, 90.0],
        change: |scene, angle| {
            let [width, height] = scene.sheet.size.take().unwrap();
            let lean = height / angle.to_radians().tan();
            let corners = [[0.0, 0.0], [width, 0.0], [width + lean, height], [lean, height]];
            scene.sheet.corners = Some(corners);
        },
    },
    Sweep {
        quantity: "thickness of a similar sheet, mm (3)",
        values: &[0.3, 1.6, 3.0, 10.0],
        change: |scene, thickness| {
            scene.thickness = Some(thickness);
            scene.process.slit_width *= thickness / 3.0;
            scene.cutting.kerf = None;
            scene.process.r_win *= thickness / 3.0;
            scene.ligament.start *= thickness / 3.0;
            scene.ligament.range = scene.ligament.range.map(|width| width * thickness / 3.0);
            scene.supports[0].clip = None;
            scene.loads[0].clip = None;
            enlarge(scene, [thickness / 3.0; 2]);
        },
    },
    Sweep {
        quantity: "panels (12), held flat",
        values: &[4.0, 12.0, 192.0, 588.0],
        change: |scene, panels| {
            // 3 columns for 4 rows.
            let columns = (0.75 * panels).sqrt().round() as usize;
            let rows = panels as usize / columns;
            scene.sheet.panels = [columns, rows];
            scene.supports[0].panel = [columns / 2, rows - 1];
            scene.loads[0].panel = [columns / 2, 0];
            enlarge(scene, [columns as f64 / 3.0, rows as f64 / 4.0]);
            scene.posture = Some(PostureConfig { kind: Posture::HeldFlat, down: None });
        },
    },
];

/// A sheet, its target and its stroke, larger by factors along x and y.
fn enlarge(scene: &mut SceneConfig, [x, y]: [f64; 2]) {
    let larger = |[width, height]: [f64; 2]| [x * width, y * height];
    scene.sheet.size = scene.sheet.size.map(larger);
    scene.drive.as_mut().unwrap().stroke *= y;
    let TargetShape::Rectangle { centre, size, .. } = &mut scene.target else {
        panic!("the target of the plate is a rectangle");
    };
    (*centre, *size) = (larger(*centre), larger(*size));
}

/// What becomes of a sheet, from the best to the worst.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Outcome {
    Solved,
    OutsideDomain,
    Jumps,
    EndsEarly,
    Refused,
}

impl Outcome {
    fn in_words(self) -> &'static str {
        match self {
            Self::Solved => "solved",
            Self::OutsideDomain => "solved, outside the training domain",
            Self::Jumps => "jumps",
            Self::EndsEarly => "ends early",
            Self::Refused => "refused",
        }
    }

    fn of(scene: &Scene, change: impl FnOnce(&mut SceneConfig)) -> Self {
        let mut config = scene.config.clone();
        change(&mut config);
        let Ok(scene) = scene.changed(config) else {
            return Self::Refused;
        };
        let problem = scene.problem().unwrap();
        match problem.deploy(&scene.start()) {
            Ok(deployment) => Self::of_path(&deployment),
            Err(_) => Self::EndsEarly,
        }
    }

    fn of_path(deployment: &Deployment) -> Self {
        let found = deployment.path.iter().map(|step| {
            let numbers = step.configuration.as_flattened().iter();
            let mut numbers = numbers.chain(&step.energies).chain([&step.potential]);
            assert!(numbers.all(|number| number.is_finite()), "{step}");
            if step.status == Status::Diverged {
                return Self::EndsEarly;
            }
            assert_ne!(step.status, Status::Almost, "{step}");
            assert!(step.residual <= step.rounding.max(1e-10), "{step}");
            match step.status {
                Status::LimitPoint => Self::Jumps,
                _ if step.inside.contains(&false) => Self::OutsideDomain,
                _ => Self::Solved,
            }
        });
        found.max().unwrap()
    }
}

/// One line for successive values with the same outcome.
fn table() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/scenes/a4-plate.toml");
    let scene = Scene::read(&path).unwrap();
    assert_eq!(scene.config.level, Level::Standard);
    let mut table =
        "| quantity (value of the scene) | tested values | outcome |\n|---|---|---|\n".to_owned();
    for sweep in &SWEEPS {
        let outcomes = sweep.values.iter().map(|value| {
            let outcome = Outcome::of(&scene, |config| (sweep.change)(config, *value));
            (*value, outcome)
        });
        let outcomes: Vec<(f64, Outcome)> = outcomes.collect();
        for (i, alike) in outcomes.chunk_by(|one, other| one.1 == other.1).enumerate() {
            let quantity = if i == 0 { sweep.quantity } else { "" };
            let values: Vec<String> = alike.iter().map(|(value, _)| shown(*value)).collect();
            let outcome = alike[0].1.in_words();
            table += &format!("| {quantity} | {} | {outcome} |\n", values.join(", "));
        }
    }
    table
}

fn shown(value: f64) -> String {
    match value.abs() {
        x if (1e-2..1e5).contains(&x) => value.to_string(),
        _ => format!("{value:e}"),
    }
}

#[test]
fn the_page_of_limits_has_the_extremes_of_a_plate() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/LIMITS.md");
    let page = std::fs::read_to_string(path).unwrap();
    let begin = page.find("| quantity (value of the scene) |").unwrap();
    let found = table();
    if std::env::var_os("KIRIGAMI_WRITE").is_some() {
        std::fs::write(path, page[..begin].to_owned() + &found).unwrap();
    } else {
        assert_eq!(
            page[begin..],
            found,
            "run `KIRIGAMI_WRITE=1 cargo test --test command_line extremes`"
        );
    }
}
