//! The alphabets ISO 8859-1 to 8859-9 that the string directives `\PA\` to `\PI\` choose and `\S\` uses.

/// Upper halves, 0xA0 to 0xFF; U+FFFD where the alphabet has no character.
const LATIN_1: &str = "\u{a0}¡¢£¤¥¦§¨©ª«¬\u{ad}®¯°±²³´µ¶·¸¹º»¼½¾¿ÀÁÂÃÄÅÆÇÈÉÊËÌÍÎÏÐÑÒÓÔÕÖ×ØÙÚÛÜÝÞßàáâãäåæçèéêëìíîïðñòóôõö÷øùúûüýþÿ";
const LATIN_2: &str = "\u{a0}Ą˘Ł¤ĽŚ§¨ŠŞŤŹ\u{ad}ŽŻ°ą˛ł´ľśˇ¸šşťź˝žżŔÁÂĂÄĹĆÇČÉĘËĚÍÎĎĐŃŇÓÔŐÖ×ŘŮÚŰÜÝŢßŕáâăäĺćçčéęëěíîďđńňóôőö÷řůúűüýţ˙";
const LATIN_3: &str = "\u{a0}Ħ˘£¤�Ĥ§¨İŞĞĴ\u{ad}�Ż°ħ²³´µĥ·¸ışğĵ½�żÀÁÂ�ÄĊĈÇÈÉÊËÌÍÎÏ�ÑÒÓÔĠÖ×ĜÙÚÛÜŬŜßàáâ�äċĉçèéêëìíîï�ñòóôġö÷ĝùúûüŭŝ˙";
const LATIN_4: &str = "\u{a0}ĄĸŖ¤ĨĻ§¨ŠĒĢŦ\u{ad}Ž¯°ą˛ŗ´ĩļˇ¸šēģŧŊžŋĀÁÂÃÄÅÆĮČÉĘËĖÍÎĪĐŅŌĶÔÕÖ×ØŲÚÛÜŨŪßāáâãäåæįčéęëėíîīđņōķôõö÷øųúûüũū˙";
const CYRILLIC: &str = "\u{a0}ЁЂЃЄЅІЇЈЉЊЋЌ\u{ad}ЎЏАБВГДЕЖЗИЙКЛМНОПРСТУФХЦЧШЩЪЫЬЭЮЯабвгдежзийклмнопрстуфхцчшщъыьэюя№ёђѓєѕіїјљњћќ§ўџ";
const GREEK: &str = "\u{a0}‘’£€₯¦§¨©ͺ«¬\u{ad}�―°±²³΄΅Ά·ΈΉΊ»Ό½ΎΏΐΑΒΓΔΕΖΗΘΙΚΛΜΝΞΟΠΡ�ΣΤΥΦΧΨΩΪΫάέήίΰαβγδεζηθικλμνξοπρςστυφχψωϊϋόύώ�";
const LATIN_5: &str = "\u{a0}¡¢£¤¥¦§¨©ª«¬\u{ad}®¯°±²³´µ¶·¸¹º»¼½¾¿ÀÁÂÃÄÅÆÇÈÉÊËÌÍÎÏĞÑÒÓÔÕÖ×ØÙÚÛÜİŞßàáâãäåæçèéêëìíîïğñòóôõö÷øùúûüışÿ";

/// Character at `offset` (0 for 0xA0, up to 95) of ISO 8859-`part`, `part` from 1 to 9.
pub(super) fn character(part: u8, offset: u8) -> Option<char> {
    let table = match part {
        1 => LATIN_1,
        2 => LATIN_2,
        3 => LATIN_3,
        4 => LATIN_4,
        5 => CYRILLIC,
        6 => return arabic(offset),
        7 => GREEK,
        8 => return hebrew(offset),
        9 => LATIN_5,
        _ => return None,
    };
    table.chars().nth(offset.into()).filter(|&c| c != char::REPLACEMENT_CHARACTER)
}

fn arabic(offset: u8) -> Option<char> {
    let code = u32::from(offset) + 0xa0;
    match code {
        0xa0 | 0xa4 | 0xad => char::from_u32(code),
        // The block keeps the order of Unicode, 0x560 further up.
        0xac | 0xbb | 0xbf | 0xc1..=0xda | 0xe0..=0xf2 => char::from_u32(code + 0x560),
        _ => None,
    }
}

fn hebrew(offset: u8) -> Option<char> {
    let code = u32::from(offset) + 0xa0;
    match code {
        0xaa => Some('\u{d7}'),
        0xba => Some('\u{f7}'),
        0xdf => Some('\u{2017}'),
        // The letters keep the order of Unicode, 0x4f0 further up.
        0xe0..=0xfa => char::from_u32(code + 0x4f0),
        0xfd => Some('\u{200e}'),
        0xfe => Some('\u{200f}'),
        0xa0 | 0xa2..=0xbe => char::from_u32(code),
        _ => None,
    }
}
