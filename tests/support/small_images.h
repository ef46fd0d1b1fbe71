// PNG and TIFF files written by the documents alone, without the libraries that are tested:
// ISO/IEC 15948 with stored deflate blocks (RFC 1951), TIFF 6.0 with one uncompressed strip.
#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace rigwire::tests {

using Bytes = std::vector<std::uint8_t>;

inline void put_be(Bytes& out, std::uint32_t value, int bytes) {
  for (int i = bytes - 1; i >= 0; --i) {
    out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
}

inline void put_le(Bytes& out, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) {
    out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
}

inline void put_chunk(Bytes& out, const std::string& type, const Bytes& data) {
  put_be(out, static_cast<std::uint32_t>(data.size()), 4);
  Bytes body(type.begin(), type.end());
  body.insert(body.end(), data.begin(), data.end());
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const std::uint8_t byte : body) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
    }
  }
  out.insert(out.end(), body.begin(), body.end());
  put_be(out, crc ^ 0xFFFFFFFFU, 4);
}

/// `samples` row by row from the top, channels side by side; at most some 60 kB.
inline Bytes png(std::uint32_t columns, std::uint32_t rows, int bits, int channels,
                 const std::vector<std::uint16_t>& samples) {
  constexpr std::uint8_t kColourTypes[] = {0, 0, 4, 2, 6};
  Bytes raw;
  std::size_t next = 0;
  for (std::uint32_t r = 0; r < rows; ++r) {
    raw.push_back(0);  // no filter
    for (std::uint32_t c = 0; c < columns * static_cast<std::uint32_t>(channels); ++c) {
      put_be(raw, samples[next++], bits / 8);
    }
  }
  std::uint32_t a = 1;
  std::uint32_t b = 0;
  for (const std::uint8_t byte : raw) {
    a = (a + byte) % 65521U;
    b = (b + a) % 65521U;
  }
  Bytes deflated{0x78, 0x01, 0x01};  // one stored block, the last
  put_le(deflated, raw.size(), 2);
  put_le(deflated, ~raw.size(), 2);
  deflated.insert(deflated.end(), raw.begin(), raw.end());
  put_be(deflated, (b << 16U) | a, 4);
  Bytes header;
  put_be(header, columns, 4);
  put_be(header, rows, 4);
  header.insert(header.end(), {static_cast<std::uint8_t>(bits), kColourTypes[channels], 0, 0, 0});
  Bytes out{0x89, 'P', 'N', 'G', 0x0D, 0x0A, 0x1A, 0x0A};
  put_chunk(out, "IHDR", header);
  put_chunk(out, "IDAT", deflated);
  put_chunk(out, "IEND", {});
  return out;
}

/// One entry of a TIFF directory; `data` in the file's byte order.
struct TiffField {
  std::uint16_t tag = 0;
  std::uint16_t type = 3;  ///< 2 text, 3 of 16 bits, 4 of 32 bits, 12 double.
  std::uint32_t count = 1;
  Bytes data;
};

template <class Number>
Bytes little_endian(const std::vector<Number>& numbers) {
  Bytes out;
  for (const Number& number : numbers) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&number);
    out.insert(out.end(), bytes, bytes + sizeof number);
  }
  return out;
}

inline TiffField shorts(std::uint16_t tag, const std::vector<std::uint16_t>& numbers) {
  return {tag, 3, static_cast<std::uint32_t>(numbers.size()), little_endian(numbers)};
}
inline TiffField doubles(std::uint16_t tag, const std::vector<double>& numbers) {
  return {tag, 12, static_cast<std::uint32_t>(numbers.size()), little_endian(numbers)};
}
inline TiffField text(std::uint16_t tag, const std::string& value) {
  Bytes data(value.begin(), value.end());
  data.push_back(0);
  return {tag, 2, static_cast<std::uint32_t>(data.size()), data};
}

/// Grey raster of one strip. `format`: 1 unsigned, 2 signed, 3 float; `more` in order of tags, all
/// above 339.
inline Bytes tiff(std::uint16_t columns, std::uint16_t rows, std::uint16_t bits,
                  std::uint16_t format, const Bytes& pixels, const std::vector<TiffField>& more) {
  constexpr std::uint32_t kHeader = 8;
  std::vector<TiffField> fields{
      shorts(256, {columns}),
      shorts(257, {rows}),
      shorts(258, {bits}),
      shorts(259, {1}),
      shorts(262, {1}),
      {273, 4, 1, little_endian<std::uint32_t>({kHeader})},
      shorts(277, {1}),
      shorts(278, {rows}),
      {279, 4, 1, little_endian<std::uint32_t>({static_cast<std::uint32_t>(pixels.size())})},
      shorts(339, {format})};
  fields.insert(fields.end(), more.begin(), more.end());
  Bytes body = pixels;
  while (body.size() % 2 != 0) {
    body.push_back(0);
  }
  Bytes directory;
  put_le(directory, fields.size(), 2);
  for (TiffField& field : fields) {
    put_le(directory, field.tag, 2);
    put_le(directory, field.type, 2);
    put_le(directory, field.count, 4);
    if (field.data.size() <= 4) {
      field.data.resize(4);
      directory.insert(directory.end(), field.data.begin(), field.data.end());
    } else {
      put_le(directory, kHeader + body.size(), 4);
      body.insert(body.end(), field.data.begin(), field.data.end());
      body.resize(body.size() + body.size() % 2);
    }
  }
  put_le(directory, 0, 4);
  Bytes out{'I', 'I', 42, 0};
  put_le(out, kHeader + body.size(), 4);
  out.insert(out.end(), body.begin(), body.end());
  out.insert(out.end(), directory.begin(), directory.end());
  return out;
}

inline void write_file(const std::string& file, const Bytes& bytes) {
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

}  // namespace rigwire::tests
