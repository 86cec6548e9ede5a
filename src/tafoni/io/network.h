#pragma once
// Nothing is fetched from the network unless the user allows it.

namespace tafoni::io {

/// From now on names may be URLs, and VRTs may name such. To be called before the first file is read: when
/// GDAL has been set up without the network, that stays so.
void allow_network();
bool network_allowed();

}  // namespace tafoni::io
