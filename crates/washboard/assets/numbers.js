// Numbers as text, and where an axis has its marks.
"use strict";
const numbers = (() => {
  const raised = (n) => "10" + String(n).replace(/./g, (c) => c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[c]);
  const plain = (v) => String(+v.toPrecision(6)).replace("-", "−");
  const value = (v) => {
    if (v == null) return "–";
    const size = Math.abs(v);
    if (size === 0 || (size >= 1e-3 && size < 1e5)) return String(+v.toPrecision(4)).replace("-", "−");
    const [digits, exponent] = v.toExponential(2).split("e");
    return digits.replace("-", "−") + "·" + raised(+exponent);
  };

  // marks of one axis in one way: with powers of ten where the largest is small or large
  const alike = (all) => {
    const largest = Math.max(...all.map(Math.abs));
    const power = largest > 0 && (largest < 1e-3 || largest >= 1e5);
    return all.map((v) => {
      if (!power || v === 0) return plain(v);
      const [digits, exponent] = (+v.toPrecision(6)).toExponential().split("e");
      return digits.replace("-", "−") + "·" + raised(+exponent);
    });
  };

  // marks of a logarithmic axis: 1, 2, 5 of each decade where there is room, else whole decades, else every other one
  function logSplits(low, high, pixels) {
    const first = Math.floor(Math.log10(low)), last = Math.ceil(Math.log10(high));
    const room = pixels / Math.max(Math.log10(high / low), 1e-9);
    const steps = room > 110 ? [1, 2, 5] : [1], stride = Math.max(1, Math.ceil(26 / room));
    const at = [];
    for (let d = first; d <= last; d++)
      if (d % stride === 0) for (const s of steps) at.push(s * 10 ** d);
    return at.filter((v) => v >= low * 0.9999 && v <= high * 1.0001);
  }
  const decade = (v) => Math.abs(Math.log10(v) % 1) < 1e-9 ? raised(Math.round(Math.log10(v))) : "";
  const logText = (v, horizontal) => v >= 0.001 && v < 10000 && horizontal ? plain(v) : decade(v);
  return { plain, alike, value, logSplits, logText };
})();
