//! Numbers of states, which outgrow every machine word.

use std::fmt;

/// A natural number of any size: its digits to the base 2^32, lowest first, without leading zeros.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Count(Vec<u32>);

impl Count {
    /// 1.
    pub fn one() -> Count {
        Count(vec![1])
    }

    /// The sum.
    #[must_use]
    pub fn plus(&self, other: &Count) -> Count {
        let mut sum = Vec::with_capacity(self.0.len().max(other.0.len()) + 1);
        let mut carry = 0u64;
        for i in 0..self.0.len().max(other.0.len()) {
            let digit = |n: &Count| u64::from(n.0.get(i).copied().unwrap_or(0));
            carry += digit(self) + digit(other);
            sum.push(carry as u32);
            carry >>= 32;
        }
        if carry > 0 {
            sum.push(carry as u32);
        }
        Count(sum)
    }

    /// `self` times 2 to the power of `bits`.
    #[must_use]
    pub fn doubled(&self, bits: usize) -> Count {
        if self.0.is_empty() {
            return Count::default();
        }
        let mut product = vec![0; bits / 32];
        let mut carry = 0u64;
        for &digit in &self.0 {
            carry |= u64::from(digit) << (bits % 32);
            product.push(carry as u32);
            carry >>= 32;
        }
        if carry > 0 {
            product.push(carry as u32);
        }
        Count(product)
    }
}

impl From<u64> for Count {
    fn from(n: u64) -> Count {
        let mut digits = vec![n as u32, (n >> 32) as u32];
        while digits.last() == Some(&0) {
            digits.pop();
        }
        Count(digits)
    }
}

impl fmt::Display for Count {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const GROUP: u64 = 1_000_000_000;
        let mut rest = self.0.clone();
        let mut groups = Vec::new();
        while !rest.is_empty() {
            let mut remainder = 0u64;
            for digit in rest.iter_mut().rev() {
                let value = remainder << 32 | u64::from(*digit);
                *digit = (value / GROUP) as u32;
                remainder = value % GROUP;
            }
            while rest.last() == Some(&0) {
                rest.pop();
            }
            groups.push(remainder);
        }
        let mut text = groups.pop().unwrap_or(0).to_string();
        groups.iter().rev().for_each(|g| text += &format!("{g:09}"));
        f.write_str(&text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_written_in_decimal() {
        assert_eq!(Count::default().to_string(), "0");
        assert_eq!(Count::from(46_350).to_string(), "46350");
        assert_eq!(Count::one().doubled(64).to_string(), "18446744073709551616");
        assert_eq!(Count::one().doubled(100).to_string(), "1267650600228229401496703205376");
        // 10^18 has groups of zeros only.
        assert_eq!(Count::from(1_000_000_000_000_000_000).to_string(), "1000000000000000000");
    }

    #[test]
    fn sums_carry() {
        let most = Count::from(u64::MAX);
        assert_eq!(most.plus(&Count::one()), Count::one().doubled(64));
        assert_eq!(most.plus(&most), most.doubled(1));
        assert_eq!(Count::from(3).doubled(33).plus(&Count::from(5)).to_string(), "25769803781");
    }
}
