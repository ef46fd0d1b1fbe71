-- A Velodyne HDL-32E dissector for tshark, written from the manual (63-9113 Rev. H) and sharing
-- nothing with protocols/velodyne: angles are computed from the optical drawing's rule (lower half
-- and upper half alternate, 4/3 degree pitch), times from the firing order.
--
--   tshark -X lua_script:velodyne.lua -r capture.pcap -T fields -e velodyne.point ...
--
-- One field "velodyne.point" per return: block laser range_m azimuth_deg elevation_deg offset_us
-- reflectivity. Anything against the manual adds a "velodyne.complaint".

local velodyne = Proto("velodyne", "Velodyne HDL-32E data")
local position = Proto("velodyne_position", "Velodyne HDL-32E position")

local fields = {
  point = ProtoField.string("velodyne.point", "Point"),
  stamp = ProtoField.uint32("velodyne.timestamp", "Microseconds past the hour"),
  mode = ProtoField.uint8("velodyne.mode", "Return mode", base.HEX),
  product = ProtoField.uint8("velodyne.product", "Product", base.HEX),
  complaint = ProtoField.string("velodyne.complaint", "Against the manual"),
}
velodyne.fields = { fields.point, fields.stamp, fields.mode, fields.product, fields.complaint }

local place = {
  stamp = ProtoField.uint32("velodyne_position.timestamp", "Microseconds past the hour"),
  pulse = ProtoField.uint8("velodyne_position.pulse", "Pulse per second"),
  sentence = ProtoField.string("velodyne_position.sentence", "Sentence"),
  complaint = ProtoField.string("velodyne_position.complaint", "Against the manual"),
}
position.fields = { place.stamp, place.pulse, place.sentence, place.complaint }

-- Laser 0, 2, 4 ... climb from -30.67, laser 1, 3, 5 ... from -9.33, both by 4/3 degree.
local function elevation(laser)
  local start = laser % 2 == 0 and -92 / 3 or -28 / 3
  return start + math.floor(laser / 2) * 4 / 3
end

local function azimuth_at(buffer, block)
  return buffer(block * 100 + 2, 2):le_uint() / 100
end

local function turn(from, to)
  local step = to - from
  if step < 0 then step = step + 360 end
  return step
end

function velodyne.dissector(buffer, packet, root)
  packet.cols.protocol = "Velodyne"
  local tree = root:add(velodyne, buffer())
  if buffer:len() ~= 1206 then
    tree:add(fields.complaint, "length " .. buffer:len())
    return
  end
  for block = 0, 11 do
    local at = block * 100
    if buffer(at, 1):uint() ~= 0xff or buffer(at + 1, 1):uint() ~= 0xee then
      tree:add(fields.complaint, "flag of block " .. block)
    end
    local azimuth = azimuth_at(buffer, block)
    if azimuth >= 360 then
      tree:add(fields.complaint, "azimuth of block " .. block)
    end
    local step
    if block < 11 then
      step = turn(azimuth, azimuth_at(buffer, block + 1))
    else
      step = turn(azimuth_at(buffer, block - 1), azimuth)
    end
    for laser = 0, 31 do
      local channel = buffer(at + 4 + laser * 3, 3)
      local counts = channel(0, 2):le_uint()
      if counts > 0 then
        local shot = azimuth + step * laser / 40 -- 40 ticks of 1.152 us make a firing cycle
        if shot >= 360 then shot = shot - 360 end
        tree:add(fields.point, channel, string.format("%d %d %.3f %.5f %.4f %.3f %d", block, laser,
          counts * 0.002, shot, elevation(laser), (block * 40 + laser) * 1.152,
          channel(2, 1):uint()))
      end
    end
  end
  tree:add_le(fields.stamp, buffer(1200, 4))
  if buffer(1200, 4):le_uint() >= 3600000000 then
    tree:add(fields.complaint, "timestamp past the hour")
  end
  tree:add(fields.mode, buffer(1204, 1))
  tree:add(fields.product, buffer(1205, 1))
end

function position.dissector(buffer, packet, root)
  packet.cols.protocol = "Velodyne position"
  local tree = root:add(position, buffer())
  if buffer:len() ~= 512 then
    tree:add(place.complaint, "length " .. buffer:len())
    return
  end
  for i = 0, 13 do
    if buffer(i, 1):uint() ~= 0 then tree:add(place.complaint, "byte " .. i .. " is not zero") end
  end
  tree:add_le(place.stamp, buffer(198, 4))
  tree:add(place.pulse, buffer(202, 1))
  local sentence = buffer(206, 306):stringz()
  local body, sum = sentence:match("^%$(GPRMC,[^*]*)%*(%x%x)\r\n$")
  local check = 0
  if body == nil then
    tree:add(place.complaint, "no GPRMC sentence")
    return
  end
  for i = 1, #body do
    -- Exclusive or without an operator: the Lua of tshark 4.0 is 5.2.
    check = bit32.bxor(check, body:byte(i))
  end
  if check ~= tonumber(sum, 16) then tree:add(place.complaint, "checksum") end
  tree:add(place.sentence, buffer(206, #sentence), body)
end

DissectorTable.get("udp.port"):add(2368, velodyne)
DissectorTable.get("udp.port"):add(8308, position)
