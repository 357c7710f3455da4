/* Packed numbers of the page: little-endian, in base64. */
function unpack(text, kind) {
  "use strict";
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; i++) bytes[i] = binary.charCodeAt(i);
  return new kind(bytes.buffer);
}
