//! The stock that a new sheet is cut from.

use anyhow::{Result, ensure};
use scene::Stock;
use toml_edit::{Array, Item, value};

/// A stock and its border that the machine cannot cut (mm).
#[derive(Clone, Copy)]
pub(super) struct CutFrom {
    pub(super) stock: Stock,
    pub(super) margin: f64,
}

impl CutFrom {
    /// Width and height of the largest sheet whose cuts fit on the stock as it lies (mm), in whole
    /// millimetres: inside of the margin, the over-run of its slits and half of the kerf (mm).
    pub(super) fn largest_sheet(self, over_run: f64, kerf: f64) -> Result<[f64; 2]> {
        let border = self.margin + over_run + 0.5 * kerf;
        let [width, height] = self.stock.size();
        let sheet = [width, height].map(|side| (side - 2.0 * border).floor());
        ensure!(
            sheet.iter().all(|side| *side > 0.0),
            "a border of {border} mm, of margin, over-run and half a kerf, leaves nothing of a stock of {width} x {height} mm: use a larger \
             --stock or a smaller --margin"
        );
        Ok(sheet)
    }

    /// Adds the stock to the table `[cutting]` of a scene.
    pub(super) fn write(self, cutting: &mut Item) {
        cutting["stock"] = match self.stock {
            Stock::Paper(paper) => value(paper.to_string()),
            Stock::Sides(sides) => value(Array::from_iter(sides)),
        };
        cutting["margin"] = value(self.margin);
        if let Some(margin) = cutting["margin"].as_value_mut() {
            margin.decor_mut().set_suffix(" # mm; border of the stock that the machine cannot cut");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Paper;

    #[test]
    fn a_sheet_is_smaller_than_its_stock_by_all_that_is_cut_beyond_its_edge() {
        let stock = Stock::Paper(Paper::A4);
        let cut_from = |margin| CutFrom { stock, margin };
        let sheet = cut_from(5.0).largest_sheet(1.0, 0.2).unwrap();
        assert_eq!(sheet, [197.0, 284.0]);
        assert!(cut_from(104.0).largest_sheet(1.0, 0.2).is_err());
    }
}
