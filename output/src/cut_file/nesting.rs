//! Several designs on sheets of one stock: what lies where, and the paths of every sheet in cutting order.
//!
//! A design takes the rectangle that the centre of the tool reaches. The crate `crunch` packs rectangles onto a
//! sheet, the largest first, each into the free rectangle that it fills best. Which way a piece is turned is decided before it is known what lies beside it, so a sheet is
//! packed again with prescribed orientations, all of them for up to [`PERIOD`] pieces. Of these packings that with the largest area
//! is kept, of equal ones that inside the smallest rectangle, and of these that with the fewest pieces turned. The sheets are
//! filled one after the other: that no other packing needs fewer is not proved.

use crate::cut_file::cut_drawing::CutDrawing;
use crate::cut_file::fabrication_error::FabricationError;
use crunch::{Item, PackedItem, Rect, Rotation, pack};
use std::cmp::Reverse;

/// Number of pieces after which the prescribed orientations repeat.
const PERIOD: usize = 7;
/// Micrometres in a millimetre: rectangles are packed in whole micrometres, rounded up.
const MICROMETRES: f64 = 1e3;
/// Rounding of lengths (um).
const ROUNDING: f64 = 1e-3;

/// A design and how often it is cut.
#[derive(Clone, Debug)]
pub struct NestedDesign {
    /// Its name, in tables, pictures and errors.
    pub name: String,
    /// The number of its pieces.
    pub copies: usize,
    /// The paths of the tool, in the frame of the design.
    pub paths: CutDrawing,
    /// Distance of the centre of the tool from these paths, on their outer side (mm): [`Machine::reach`].
    ///
    /// [`Machine::reach`]: crate::cut_file::Machine::reach
    pub reach: f64,
    /// Width of the kerf (mm).
    pub kerf: f64,
    /// Area of a piece (mm^2).
    pub area: f64,
}

impl NestedDesign {
    /// Width and height of what the centre of the tool reaches (mm).
    fn size(&self) -> [f64; 2] {
        let [low, high] = self.paths.bounds();
        [0, 1].map(|axis| high[axis] - low[axis] + 2.0 * self.reach)
    }
}

/// The material on which designs are laid.
#[derive(Clone, Copy, Debug)]
pub struct NestingStock {
    /// Width and height of a sheet (mm).
    pub size: [f64; 2],
    /// Border that the machine cannot cut (mm).
    pub margin: f64,
    /// Width of the material that remains between two pieces (mm).
    pub gap: f64,
    /// Whether pieces may be turned by 90 degrees.
    pub turns: bool,
}

/// A piece on its sheet of stock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Index of its design.
    pub design: usize,
    /// Which of the pieces of its design it is, from 1.
    pub copy: usize,
    /// Whether it is turned by 90 degrees, counter-clockwise.
    pub turned: bool,
    /// Lower left corner of its paths, from that of the stock (mm).
    pub corner: [f64; 2],
    /// Width and height of its paths as they lie (mm).
    pub size: [f64; 2],
}

/// A sheet of stock with its pieces.
#[derive(Clone, Debug)]
pub struct NestedSheet {
    /// Its pieces, by design and copy.
    pub places: Vec<Place>,
    /// The paths of all pieces in cutting order, from the lower left corner of the stock.
    pub drawing: CutDrawing,
}

/// Lays all pieces of the designs on sheets of stock; an error if a design does not fit on one.
pub fn nest(
    designs: &[NestedDesign],
    stock: &NestingStock,
) -> Result<Vec<NestedSheet>, FabricationError> {
    let packing = Packing::new(designs, stock)?;
    let mut left = packing.pieces(designs);
    let mut copies = vec![0; designs.len()];
    let mut sheets = Vec::new();
    while !left.is_empty() {
        let packed = packing.fullest(&left);
        let mut drawing = CutDrawing::default();
        let mut places = Vec::with_capacity(packed.len());
        for item in packed {
            let (turned, PackedItem { data: piece, rect }) = (is_turned(&item), item);
            left.retain(|other| other.number != piece.number);
            let NestedDesign { paths, reach, .. } = &designs[piece.design];
            let mut paths = paths.clone();
            if turned {
                paths.turn();
            }
            let [low, high] = paths.bounds();
            let corner = [rect.x, rect.y].map(|x| stock.margin + reach + x as f64 / MICROMETRES);
            paths.shift([0, 1].map(|axis| corner[axis] - low[axis]));
            drawing.shapes.append(&mut paths.shapes);
            copies[piece.design] += 1;
            places.push(Place {
                design: piece.design,
                copy: copies[piece.design],
                turned,
                corner,
                size: [0, 1].map(|axis| high[axis] - low[axis]),
            });
        }
        places.sort_by_key(|place| (place.design, place.copy));
        sheets.push(NestedSheet {
            places,
            drawing: drawing.in_cutting_order([0.0; 2]),
        });
    }
    Ok(sheets)
}

/// A piece that is to be packed.
#[derive(Clone, Copy)]
struct Piece {
    number: usize,
    design: usize,
    /// Width and height of what the tool reaches, with the distance to the next piece (um).
    sides: [usize; 2],
}

fn is_turned(item: &PackedItem<Piece>) -> bool {
    item.rect.w != item.data.sides[0]
}

/// The rectangle inside the margin of a sheet of stock, and those of the designs, each with the distance to the next piece (um).
struct Packing {
    room: [usize; 2],
    designs: Vec<[usize; 2]>,
    turns: bool,
}

impl Packing {
    fn new(designs: &[NestedDesign], stock: &NestingStock) -> Result<Self, FabricationError> {
        let kerf = designs.iter().map(|design| design.kerf).fold(0.0, f64::max);
        let apart = stock.gap + kerf;
        let micrometres = |mm: f64| (MICROMETRES * (mm + apart) - ROUNDING).ceil() as usize;
        let room = stock.size.map(|side| (side - 2.0 * stock.margin).max(0.0));
        let packing = Self {
            room: room.map(micrometres),
            designs: (designs.iter())
                .map(|design| design.size().map(micrometres))
                .collect(),
            turns: stock.turns,
        };
        for (design, [width, height]) in designs.iter().zip(packing.designs.iter().copied()) {
            let fits_turned = packing.holds([height, width]);
            if !(packing.holds([width, height]) || packing.turns && fits_turned) {
                return Err(FabricationError::LargerThanStock {
                    name: design.name.clone(),
                    size: design.size(),
                    room,
                    fits_turned,
                });
            }
        }
        Ok(packing)
    }

    /// Whether a rectangle fits as it is.
    fn holds(&self, sides: [usize; 2]) -> bool {
        std::iter::zip(sides, self.room).all(|(side, room)| side <= room)
    }

    /// All pieces in the order in which they are packed: by the area and then by the longer side.
    fn pieces(&self, designs: &[NestedDesign]) -> Vec<Piece> {
        let all = (designs.iter().zip(&self.designs).enumerate())
            .flat_map(|(i, (design, sides))| std::iter::repeat_n((i, *sides), design.copies));
        let mut pieces: Vec<Piece> = (all.enumerate())
            .map(|(number, (design, sides))| Piece {
                number,
                design,
                sides,
            })
            .collect();
        pieces.sort_by_key(|piece| {
            let [width, height] = piece.sides;
            Reverse(width * height + width.max(height))
        });
        pieces
    }

    /// The fullest of the packings of one sheet.
    fn fullest(&self, left: &[Piece]) -> Vec<PackedItem<Piece>> {
        let orientations = if self.turns { 1 << PERIOD } else { 1 };
        let free = self.turns.then(|| self.packed(left, |_| None));
        let prescribed = (0..orientations)
            .map(|turned: usize| self.packed(left, |i| Some(turned >> (i % PERIOD) & 1 == 1)));
        let packings = free.into_iter().chain(prescribed);
        let best = packings.max_by_key(|packing| {
            let rects = || packing.iter().map(|item| item.rect);
            let area: usize = rects().map(|rect| rect.area()).sum();
            let right = rects().map(|rect| rect.right()).max().unwrap_or(0);
            let top = rects().map(|rect| rect.bottom()).max().unwrap_or(0);
            let turned = packing.iter().filter(|item| is_turned(item)).count();
            (area, Reverse((right * top, turned)))
        });
        best.unwrap_or_default()
    }

    /// A packing of one sheet, in which piece `i` is turned as `turned(i)` says, or as it fits best.
    fn packed(
        &self,
        left: &[Piece],
        turned: impl Fn(usize) -> Option<bool>,
    ) -> Vec<PackedItem<Piece>> {
        let item = |(i, piece): (usize, &Piece)| {
            let [width, height] = piece.sides;
            let Some(turned) = turned(i) else {
                return Item::new(*piece, width, height, Rotation::Allowed);
            };
            let ways = [[width, height], [height, width]];
            let way = usize::from(turned);
            let [w, h] = if self.holds(ways[way]) {
                ways[way]
            } else {
                ways[1 - way]
            };
            Item::new(*piece, w, h, Rotation::None)
        };
        let mut items: Vec<Item<Piece>> = left.iter().enumerate().map(item).collect();
        let room = Rect::of_size(self.room[0], self.room[1]);
        loop {
            match pack(room, items.iter().cloned()) {
                Ok(packed) => return packed,
                // The packing ends at the first piece without a place: others of its size have none either.
                Err(packed) => {
                    let none = items[packed.len()].clone();
                    let mut index = 0;
                    items.retain(|item| {
                        index += 1;
                        index <= packed.len() || [item.w, item.h] != [none.w, none.h]
                    });
                }
            }
        }
    }
}
