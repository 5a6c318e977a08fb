//! ISO 10303-21 exchange files and the entities of AP203, AP214 and AP242 that carry geometry.
