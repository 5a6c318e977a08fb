//! One table for reading and writing: names, supertypes and attributes of the entities with a view.
//!
//! The table is `schemas/step/entities.tsv`, read once. It flattens inheritance as ISO 10303-21 maps a
//! simple instance: attributes of the supertypes first, each ancestor once, then the entity's own. It
//! checks no value and knows no rule beyond order and kind.
//!
//! INVARIANT: the table has one row for each [`Entity`], in the same order; a test holds both.

use std::sync::OnceLock;

use super::entity::Entity;

const TABLE: &str = include_str!("../../schemas/step/entities.tsv");

/// What the value of an attribute is, lists aside.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ValueKind {
    /// `'text'`.
    String,
    /// `1.5`.
    Real,
    /// `3`.
    Integer,
    /// `.T.` or `.F.`.
    Boolean,
    /// `.T.`, `.F.` or `.U.`.
    Logical,
    /// `.WORD.`.
    Enumeration,
    /// `#12`.
    Reference,
    /// A reference or a typed value.
    Select,
}

/// One attribute of an entity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Attribute {
    /// Name in lower case.
    pub name: &'static str,
    /// What its value, or the innermost member of its lists, is.
    pub kind: ValueKind,
    /// How many lists lie around the value: 0, 1 or 2.
    pub nesting: u8,
    /// Whether `$` is a value.
    pub optional: bool,
    /// Whether the entity derives it, so that `*` stands in the file.
    pub derived: bool,
}

/// The row of one entity.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EntityRow {
    /// The entity.
    pub entity: Entity,
    /// Short name of the exchange structure, where one is known.
    pub short_name: Option<&'static str>,
    /// Direct supertypes within the table.
    pub supertypes: Vec<Entity>,
    /// All supertypes within the table, without the entity itself.
    pub ancestors: Vec<Entity>,
    /// Attributes that a partial record of a complex instance carries.
    pub own: Vec<Attribute>,
    /// Attributes that the record of a simple instance carries.
    pub flattened: Vec<Attribute>,
    /// Part of ISO 10303 that defines it; for part 42 with the chapter (4 geometry, 5 topology, 6 models).
    pub clause: &'static str,
}

/// The row of an entity.
#[must_use]
pub fn row(entity: Entity) -> &'static EntityRow {
    &table().rows[entity as usize]
}

/// Attributes of a simple instance, in the order of its parameters.
#[must_use]
pub fn attributes(entity: Entity) -> &'static [Attribute] {
    &row(entity).flattened
}

/// Whether `entity` is `other` or one of its subtypes.
#[must_use]
pub fn is_a(entity: Entity, other: Entity) -> bool {
    entity == other || row(entity).ancestors.contains(&other)
}

/// The entity that a keyword names, whatever its case; long and short names alike.
#[must_use]
pub fn classify(keyword: &[u8]) -> Option<Entity> {
    let table = table();
    let mut slot = bucket(keyword);
    // INVARIANT: at most a quarter of the slots is taken, so an empty one ends every search.
    loop {
        let (name, entity) = table.slots[slot]?;
        if name.len() == keyword.len() && name.as_bytes().eq_ignore_ascii_case(keyword) {
            return Some(entity);
        }
        slot = (slot + 1) % SLOTS;
    }
}

/// Slots of the hash table: a power of two, four times the names or more.
const SLOTS: usize = 2048;

/// Slot where the search for a keyword begins: the length, and a few bytes whose case is put aside.
fn bucket(keyword: &[u8]) -> usize {
    let at = |index: usize| u32::from(keyword.get(index).copied().unwrap_or(0) & 0xDF);
    let n = keyword.len();
    let mut hash = n as u32;
    for index in [0, 2, n / 3, n / 2, n.saturating_sub(6), n.saturating_sub(2)] {
        hash = hash.wrapping_mul(31).wrapping_add(at(index));
    }
    (hash.wrapping_mul(0x9E37_79B1) >> 21) as usize % SLOTS
}

struct Table {
    rows: Vec<EntityRow>,
    slots: Vec<Option<(&'static str, Entity)>>,
}

fn table() -> &'static Table {
    static PARSED: OnceLock<Table> = OnceLock::new();
    PARSED.get_or_init(|| {
        let mut rows = TABLE.lines().filter(|line| !line.starts_with('#')).map(parse_row).collect::<Vec<_>>();
        assert_eq!(rows.len(), Entity::ALL.len(), "one row for each entity");
        for index in 0..rows.len() {
            let ancestors = ancestors(&rows, rows[index].entity);
            rows[index].flattened = flatten(&rows, &ancestors, index);
            rows[index].ancestors = ancestors;
        }
        let slots = hash_names(&rows);
        Table { rows, slots }
    })
}

fn hash_names(rows: &[EntityRow]) -> Vec<Option<(&'static str, Entity)>> {
    let mut slots = vec![None; SLOTS];
    for row in rows {
        for name in std::iter::once(row.entity.name()).chain(row.short_name) {
            let mut slot = bucket(name.as_bytes());
            while slots[slot].is_some() {
                slot = (slot + 1) % SLOTS;
            }
            slots[slot] = Some((name, row.entity));
        }
    }
    slots
}

fn parse_row(line: &'static str) -> EntityRow {
    let mut cells = line.split('\t');
    let mut cell = || cells.next().expect("the table has six columns").trim();
    let (name, short, supertypes, own, derived, clause) = (cell(), cell(), cell(), cell(), cell(), cell());
    // Derived attributes are kept in `flattened` until `flatten` marks them there.
    let derived = derived.split_whitespace().map(|name| parse_attribute(name, true)).collect();
    EntityRow {
        entity: by_name(name),
        short_name: (!short.is_empty()).then_some(short),
        supertypes: supertypes.split_whitespace().map(by_name).collect(),
        ancestors: Vec::new(),
        own: own.split_whitespace().map(|text| parse_attribute(text, false)).collect(),
        flattened: derived,
        clause,
    }
}

fn by_name(name: &str) -> Entity {
    let at = Entity::ALL.binary_search_by(|entity| entity.name().cmp(name));
    Entity::ALL[at.unwrap_or_else(|_| panic!("the table names {name}, which is no entity"))]
}

fn parse_attribute(text: &'static str, derived: bool) -> Attribute {
    let (name, kind) = text.split_once(':').unwrap_or((text, "ref"));
    let optional = kind.ends_with('?');
    let kind = kind.trim_end_matches('?');
    let word = kind.trim_end_matches("[]");
    let nesting = ((kind.len() - word.len()) / 2) as u8;
    let kind = match word {
        "string" => ValueKind::String,
        "real" => ValueKind::Real,
        "integer" => ValueKind::Integer,
        "boolean" => ValueKind::Boolean,
        "logical" => ValueKind::Logical,
        "enum" => ValueKind::Enumeration,
        "ref" => ValueKind::Reference,
        "select" => ValueKind::Select,
        other => panic!("the table uses {other}, which is no kind of value"),
    };
    Attribute { name, kind, nesting, optional, derived }
}

/// Ancestors in the order in which a simple instance writes their attributes.
fn ancestors(rows: &[EntityRow], entity: Entity) -> Vec<Entity> {
    let mut order = Vec::new();
    for &supertype in &rows[entity as usize].supertypes {
        for ancestor in ancestors(rows, supertype).into_iter().chain([supertype]) {
            if !order.contains(&ancestor) {
                order.push(ancestor);
            }
        }
    }
    order
}

fn flatten(rows: &[EntityRow], ancestors: &[Entity], index: usize) -> Vec<Attribute> {
    let own = &rows[index];
    let mut derived: Vec<&str> = own.flattened.iter().filter(|a| a.derived).map(|a| a.name).collect();
    for &ancestor in ancestors {
        derived.extend(rows[ancestor as usize].flattened.iter().filter(|a| a.derived).map(|a| a.name));
    }
    let chain = ancestors.iter().map(|&ancestor| &rows[ancestor as usize]).chain([own]);
    chain
        .flat_map(|row| row.own.iter().map(move |attribute| (row.entity, *attribute)))
        .map(|(holder, attribute)| Attribute {
            // An attribute that redeclares a name, as `SI_UNIT.name` does not, keeps its own value.
            derived: holder != own.entity && derived.contains(&attribute.name),
            ..attribute
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(entity: Entity) -> Vec<&'static str> {
        attributes(entity).iter().map(|a| a.name).collect()
    }

    #[test]
    fn each_entity_has_its_row_and_is_found_by_any_case() {
        for &entity in Entity::ALL {
            assert_eq!(row(entity).entity, entity);
            assert_eq!(classify(entity.name().as_bytes()), Some(entity));
            assert_eq!(classify(entity.name().to_lowercase().as_bytes()), Some(entity));
        }
        assert!(Entity::ALL.windows(2).all(|pair| pair[0].name() < pair[1].name()));
        assert_eq!(classify(b"!PLANE"), None);
        assert_eq!(classify(b""), None);
        assert_eq!(classify(b"PLANES"), None);
    }

    #[test]
    fn attributes_are_flattened_as_files_write_them() {
        assert_eq!(names(Entity::AdvancedFace), ["name", "bounds", "face_geometry", "same_sense"]);
        assert_eq!(names(Entity::EdgeLoop), ["name", "edge_list"]);
        let oriented = ["name", "edge_start", "edge_end", "edge_element", "orientation"];
        assert_eq!(names(Entity::OrientedEdge), oriented);
        let curve = [
            "name",
            "degree",
            "control_points_list",
            "curve_form",
            "closed_curve",
            "self_intersect",
            "knot_multiplicities",
            "knots",
            "knot_spec",
        ];
        assert_eq!(names(Entity::BSplineCurveWithKnots), curve);
        let derived = |entity: Entity| -> Vec<&str> {
            attributes(entity).iter().filter(|a| a.derived).map(|a| a.name).collect()
        };
        assert_eq!(derived(Entity::OrientedEdge), ["edge_start", "edge_end"]);
        assert_eq!(derived(Entity::SeamEdge), ["edge_start", "edge_end"]);
        assert_eq!(derived(Entity::SiUnit), ["dimensions"]);
        assert_eq!(derived(Entity::EdgeCurve), [""; 0]);
    }

    #[test]
    fn subtypes_are_known() {
        assert!(is_a(Entity::AdvancedFace, Entity::Face));
        assert!(is_a(Entity::BezierSurface, Entity::Surface));
        assert!(!is_a(Entity::Plane, Entity::BSplineSurface));
    }
}
