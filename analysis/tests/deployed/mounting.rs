//! A plate that is opened by hand, released, and fastened on a board.

use crate::shipped;
use analysis::mounting::Mounting;
use scene::Scene;

/// The places of three middles when the hinges of squares open by 23 deg: panels move apart by 17 %.
const FASTENERS: [([usize; 2], [f64; 2]); 3] =
    [([0, 0], [0.0, 0.0]), ([2, 3], [23.8, 37.9]), ([2, 0], [23.8, 0.0])];

/// The A4 plate on three fasteners, with its law of released hinges or without one.
fn mounting(law: bool) -> Mounting {
    let file = shipped("a4-plate.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    let (before, after) = text.split_once("[posture]").unwrap();
    let (_, after) = after.split_once("[target.rectangle]").unwrap();
    let fastener = |(panel, displacement)| {
        format!(
            "[[supports]]\npanel = {panel:?}\nkind = \"pin\"\nhole = 4.2\ndisplacement = {displacement:?}\n"
        )
    };
    let fasteners: String = FASTENERS.map(fastener).concat();
    let mut text =
        format!("{before}[posture]\nkind = \"mounted\"\n{fasteners}[target.rectangle]{after}");
    if !law {
        text = text.replace("springback = ", "# springback = ");
    }
    let scene = Scene::new(support::toml_file::parse(&text, &file).unwrap(), &file).unwrap();
    let problem = scene.problem().unwrap();
    let deployment = problem.deploy(&scene.start()).unwrap();
    Mounting::new(&scene, &problem, &deployment).unwrap()
}

/// Its residual opening leaves short ways to its fasteners, and it ends as if all moved at once.
#[test]
fn a_plate_is_fastened_from_its_residual_opening() {
    let [by_law, by_stiffness] = [true, false].map(mounting);
    for mounting in [&by_law, &by_stiffness] {
        assert!(mounting.is_complete() && mounting.apart < 0.3, "{}", mounting.apart);
        let way = mounting.fasteners[1].way;
        assert!(way > 0.0 && way < 0.5 * f64::hypot(23.8, 37.9), "{way}");
        assert!(mounting.fasteners.iter().all(|it| it.outside == 0 && it.damage.is_some()));
    }
    // Flat hinges are less stiff: they would spring back less than they do.
    let [law, stiffness] = [by_law, by_stiffness].map(|mounting| mounting.by_hand.unwrap());
    assert!((20.0..26.0).contains(&law.opened.to_degrees()), "{law:?}");
    let [law, stiffness] = [law, stiffness].map(|it| 1.0 - it.stays / it.opened);
    assert!((0.2..0.4).contains(&law) && (0.1..law).contains(&stiffness), "{law} {stiffness}");
}
