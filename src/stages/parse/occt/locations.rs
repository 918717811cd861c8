//! Where shapes lie: chains of elementary placements, so that equal places are told apart from different ones exactly.

use rustc_hash::FxHashMap;

use super::text::{Found, Lost, Words, cancelled};
use crate::cancel::Cancel;
use crate::geometry::{Matrix, Transform, Vector};
use crate::stages::parse::sound::Why;

/// The most elementary placements in one chain.
const LONGEST_CHAIN: usize = 256;
/// The most different places of one file.
const MOST_PLACES: usize = 1 << 20;
/// How far the columns of a placement may be from equally long and perpendicular, as a share of their length.
const SKEW: f64 = 1e-5;

/// Index of a place; 0 is where nothing moves.
pub(super) type Place = u32;

/// Elementary placements with their powers; the first is applied last.
type Chain = Vec<(u32, i32)>;

/// The locations of a file and all that are composed of them.
#[derive(Clone, Debug)]
pub(super) struct Locations {
    /// The elementary placements.
    datums: Vec<Option<Transform>>,
    places: FxHashMap<Chain, Place>,
    chains: Vec<Chain>,
    transforms: Vec<Option<Transform>>,
    /// The place of each location of the file; number 0 is none.
    numbered: Vec<Result<Place, Why>>,
    products: FxHashMap<(Place, Place), Place>,
}

impl Locations {
    /// Only the place where nothing moves.
    fn new() -> Self {
        let nowhere = Chain::new();
        Self {
            datums: Vec::new(),
            places: FxHashMap::from_iter([(nowhere.clone(), 0)]),
            chains: vec![nowhere],
            transforms: vec![Some(Transform::identity())],
            numbered: vec![Ok(0)],
            products: FxHashMap::default(),
        }
    }

    /// Reads the section `Locations`.
    pub fn read(words: &mut Words, cancel: &Cancel) -> Found<Self> {
        let mut locations = Self::new();
        let count = words.count()?;
        for _ in 0..count {
            cancelled(cancel)?;
            let place = match words.integer()? {
                1 => locations.elementary(words)?,
                2 => locations.composed(words)?,
                other => return Err(Lost(format!("there is no location of type {other}").into())),
            };
            locations.numbered.push(place);
        }
        Ok(locations)
    }

    fn elementary(&mut self, words: &mut Words) -> Found<Result<Place, Why>> {
        let [a, b, c]: [[f64; 4]; 3] = [words.reals()?, words.reals()?, words.reals()?];
        let linear = Matrix::new(a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]);
        let transform = Transform { linear, translation: Vector::new(a[3], b[3], c[3]) };
        self.datums.push(is_similarity(&transform).then_some(transform));
        Ok(self.place(vec![(self.datums.len() as u32 - 1, 1)]))
    }

    /// Each further location of the list is applied after those before it.
    fn composed(&mut self, words: &mut Words) -> Found<Result<Place, Why>> {
        let mut chain = Ok(Chain::new());
        loop {
            let number = words.index()?;
            if number == 0 {
                break;
            }
            let power = words.integer()?;
            chain = chain.and_then(|inner| self.raised(number, power).and_then(|outer| joined(&outer, &inner)));
        }
        Ok(chain.and_then(|chain| self.place(chain)))
    }

    /// A power of an earlier location.
    fn raised(&self, number: u32, power: i64) -> Result<Chain, Why> {
        let chain = &self.chains[self.numbered(number)? as usize];
        let power = i32::try_from(power).map_err(|_| "a location to an impossible power")?;
        if let [(datum, own)] = chain[..] {
            let product = own.checked_mul(power).ok_or("a location to an impossible power")?;
            return Ok(if product == 0 { Chain::new() } else { vec![(datum, product)] });
        }
        if power.unsigned_abs() as usize > LONGEST_CHAIN {
            return Err("a location to an impossible power");
        }
        let turned = || chain.iter().rev().map(|&(datum, p)| (datum, -p)).collect::<Chain>();
        let one = if power < 0 { turned() } else { chain.clone() };
        (0..power.unsigned_abs()).try_fold(Chain::new(), |all, _| joined(&all, &one))
    }

    /// The place of a location of the file.
    ///
    /// # Errors
    /// Where there is no such location or it is not a similarity.
    pub fn numbered(&self, number: u32) -> Result<Place, Why> {
        self.numbered.get(number as usize).copied().unwrap_or(Err("a location that is not there"))
    }

    fn place(&mut self, chain: Chain) -> Result<Place, Why> {
        if let Some(&known) = self.places.get(&chain) {
            return Ok(known);
        }
        if self.chains.len() >= MOST_PLACES {
            return Err("more places than any use");
        }
        let transform = self.product(&chain);
        let place = self.chains.len() as Place;
        self.places.insert(chain.clone(), place);
        self.chains.push(chain);
        self.transforms.push(transform);
        Ok(place)
    }

    fn product(&self, chain: &Chain) -> Option<Transform> {
        let all = chain.iter().try_fold(Transform::identity(), |all, &(datum, power)| {
            Some(all.after(&raised_transform(&self.datums[datum as usize]?, power)?))
        })?;
        is_similarity(&all).then_some(all)
    }

    /// The place `inner` seen from outside `outer`.
    ///
    /// # Errors
    /// Where the chain becomes too long.
    pub fn compose(&mut self, outer: Place, inner: Place) -> Result<Place, Why> {
        if outer == 0 || inner == 0 {
            return Ok(outer.max(inner));
        }
        if let Some(&known) = self.products.get(&(outer, inner)) {
            return Ok(known);
        }
        let chain = joined(&self.chains[outer as usize], &self.chains[inner as usize])?;
        let place = self.place(chain)?;
        self.products.insert((outer, inner), place);
        Ok(place)
    }

    /// The map of a place; `None` where nothing moves.
    ///
    /// # Errors
    /// Where it is not a similarity.
    pub fn transform(&self, place: Place) -> Result<Option<&Transform>, Why> {
        match &self.transforms[place as usize] {
            Some(_) if place == 0 => Ok(None),
            Some(transform) => Ok(Some(transform)),
            None => Err("a location that is not a similarity"),
        }
    }
}

/// One chain after the other; neighbours of the same placement are added up.
fn joined(outer: &Chain, inner: &Chain) -> Result<Chain, Why> {
    let mut chain = outer.clone();
    for &(datum, power) in inner {
        match chain.last_mut() {
            Some((last, sum)) if *last == datum => {
                *sum = sum.checked_add(power).ok_or("a location to an impossible power")?;
                if *sum == 0 {
                    chain.pop();
                }
            }
            _ => chain.push((datum, power)),
        }
    }
    if chain.len() > LONGEST_CHAIN { Err("locations nested too deep") } else { Ok(chain) }
}

/// By repeated squaring.
fn raised_transform(transform: &Transform, power: i32) -> Option<Transform> {
    let mut square = if power < 0 { transform.inverse()? } else { *transform };
    let (mut left, mut product) = (power.unsigned_abs(), Transform::identity());
    while left > 0 {
        if left & 1 == 1 {
            product = product.after(&square);
        }
        square = square.after(&square);
        left >>= 1;
    }
    Some(product)
}

/// An orthogonal matrix times a factor above 0.
fn is_similarity(transform: &Transform) -> bool {
    let gram = transform.linear.transpose() * transform.linear;
    let scale = gram.trace() / 3.0;
    let finite = transform.translation.iter().all(|x| x.is_finite()) && scale.is_finite();
    finite && scale > 0.0 && (gram / scale - Matrix::identity()).amax() <= SKEW
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;

    /// A turn by 90 degrees about z, a shift by 10 along x, what OCCT writes for shift * turn * shift^2, a power.
    const SECTION: &str = "4
        1  0 -1 0 0  1 0 0 0  0 0 1 0
        1  1 0 0 10  0 1 0 0  0 0 1 0
        2  2 2 1 1 2 1 0
        2  3 -1 0";

    fn read(text: &str) -> Locations {
        Locations::read(&mut Words::new(text.as_bytes()), &Cancel::new()).unwrap()
    }

    #[test]
    fn composed_locations_apply_the_last_of_the_list_last() {
        let mut locations = read(SECTION);
        let place = locations.numbered(3).unwrap();
        let there = locations.transform(place).unwrap().unwrap().point(&Point::origin());
        assert!((there - Point::new(10.0, 20.0, 0.0)).norm() < 1e-12);
        let back = locations.numbered(4).unwrap();
        assert_eq!(locations.compose(place, back), Ok(0), "a place and its inverse cancel exactly");
    }

    #[test]
    fn impossible_locations_are_refused_where_they_are_used() {
        let locations = read("3  1 1 0 0 0 0 2 0 0 0 0 1 0   2 7 1 0   2 1 99999999999 0");
        assert_eq!(locations.transform(locations.numbered(1).unwrap()), Err("a location that is not a similarity"));
        assert_eq!(locations.numbered(2), Err("a location that is not there"));
        assert_eq!(locations.numbered(3), Err("a location to an impossible power"));
    }

    #[test]
    fn doubling_chains_end() {
        let mut text = "40 1 0 -1 0 0 1 0 0 0 0 0 1 0   1 1 0 0 10 0 1 0 0 0 0 1 0   2 1 1 2 1 0".to_owned();
        (3..40).for_each(|i| text += &format!(" 2 {i} 2 0"));
        assert_eq!(read(&text).numbered(39), Err("locations nested too deep"));
    }
}
